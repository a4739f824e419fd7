#ifndef STEADFAST_@NAME@_CONTROLLER_HPP
#define STEADFAST_@NAME@_CONTROLLER_HPP

#include "@Class@ControllerComponentAc.hpp"

extern "C" {
#include "@name@.h"
}

namespace Steadfast {

// A component of F Prime around the controller of @name@.h. Put this folder into a deployment, add @name@.c to the
// SOURCE_FILES of its CMakeLists.txt with the option -ffp-contract=off, and connect measurementIn to what samples the sensors.
class @Class@Controller final : public @Class@ControllerComponentBase {
  public:
    explicit @Class@Controller(const char *const name);

  private:
    void measurementIn_handler(
        FwIndexType port,
        F64 time_s,
        const @Class@Quaternion &error_quaternion,
        const @Class@Rate &rate_rad_s) override;

    @name@_controller m_controller;
    U32 m_messages;
};

}  // namespace Steadfast

#endif
