#include "@Class@Controller.hpp"

namespace Steadfast {

@Class@Controller::@Class@Controller(const char *const name) : @Class@ControllerComponentBase(name), m_messages(0) {
    @name@_init(&this->m_controller);
}

void @Class@Controller::measurementIn_handler(
    FwIndexType port,
    F64 time_s,
    const @Class@Quaternion &error_quaternion,
    const @Class@Rate &rate_rad_s) {
    static_cast<void>(port);
    double error[4];
    double rate[3];
    for (FwSizeType index = 0; index < 4; ++index) {
        error[index] = error_quaternion[index];
    }
    for (FwSizeType index = 0; index < 3; ++index) {
        rate[index] = rate_rad_s[index];
    }
    @name@_command command;
    const @name@_status status = @name@_step(&this->m_controller, time_s, error, rate, &command);
    if (status >= @NAME@_HELD_TIME_NOT_FINITE) {
        this->log_WARNING_HI_SampleHeld(static_cast<U8>(status));
    }
    if (command.sent != 0U) {
        ++this->m_messages;
    }
    this->tlmWrite_SampleStatus(static_cast<U8>(status));
    this->tlmWrite_Messages(this->m_messages);
    this->commandOut_out(0, @Class@Torque(command.torque_nm[0], command.torque_nm[1], command.torque_nm[2]), command.sent != 0U);
}

}  // namespace Steadfast
