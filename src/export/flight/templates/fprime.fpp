@about_file_fpp@

module Steadfast {

  @ Error quaternion of the attitude against the desired one, scalar part first
  array @Class@Quaternion = [4] F64

  @ Rate error about the body axes (rad/s)
  array @Class@Rate = [3] F64

  @ Torque about the body axes (N m)
  array @Class@Torque = [3] F64

  @ A sample of the sensors
  port @Class@Measurement(
    time_s: F64 @< time of the sample (s)
    error_quaternion: @Class@Quaternion
    rate_rad_s: @Class@Rate
  )

  @ The command in force after a sample
  port @Class@Command(
    torque_nm: @Class@Torque
    sent: bool @< whether the trigger fired, so that a message is due
  )

  @ The attitude controller '@name@'
  passive component @Class@Controller {

    @ Called at each sample
    sync input port measurementIn: @Class@Measurement

    @ Called after each sample
    output port commandOut: @Class@Command

    time get port timeCaller
    telemetry port tlmOut
    event port logOut
    text event port logTextOut

    @ Messages sent
    telemetry Messages: U32

    @ Status of the last sample: 0 used, 1 and 2 not covered by the proof, 3 and above not used
    telemetry SampleStatus: U8

    @ A sample was not used: the command in force is held
    event SampleHeld(
      status: U8 @< 3 time not finite, 4 not increasing, 5 measurement not finite, 6 no unit quaternion, 7 overflow
    ) severity warning high format "sample not used, status {}" throttle 5

  }

}
