/*
 * A skeleton of an application of the core Flight System around the controller of @name@.h. It waits for messages with
 * measurements and sends one with the command after each. Message identifiers are of your mission: replace the two below,
 * compile @name@.c with -ffp-contract=off, and start @NAME@_AppMain from the startup script.
 */
#include "cfe.h"

#include "@name@.h"

#define @NAME@_MEASUREMENT_MID 0x18F0 /* in: @name@_measurement_message */
#define @NAME@_COMMAND_MID 0x08F0     /* out: @name@_command_message */
#define @NAME@_PIPE_DEPTH 4
#define @NAME@_HELD_EID 1

typedef struct {
    CFE_MSG_CommandHeader_t header;
    double time_s;
    double error_quaternion[4]; /* scalar part first */
    double rate_rad_s[3];
} @name@_measurement_message;

typedef struct {
    CFE_MSG_TelemetryHeader_t header;
    double torque_nm[3];
    uint32 messages;
    uint8 sent;
    uint8 status;
} @name@_command_message;

static @name@_controller controller;
static @name@_command_message answer;

/* One sample. */
static void take(const @name@_measurement_message *measured)
{
    @name@_command command;
    int axis;
    const @name@_status status =
        @name@_step(&controller, measured->time_s, measured->error_quaternion, measured->rate_rad_s, &command);
    if (status >= @NAME@_HELD_TIME_NOT_FINITE) {
        CFE_EVS_SendEvent(@NAME@_HELD_EID, CFE_EVS_EventType_ERROR, "@name@: sample not used, status %d", (int)status);
    }
    for (axis = 0; axis < 3; ++axis) {
        answer.torque_nm[axis] = command.torque_nm[axis];
    }
    answer.sent = command.sent;
    answer.status = (uint8)status;
    answer.messages += command.sent;
    CFE_SB_TimeStampMsg(CFE_MSG_PTR(answer.header));
    CFE_SB_TransmitMsg(CFE_MSG_PTR(answer.header), true);
}

void @NAME@_AppMain(void)
{
    uint32 run = CFE_ES_RunStatus_APP_RUN;
    CFE_SB_PipeId_t pipe;
    CFE_SB_Buffer_t *buffer;
    @name@_init(&controller);
    CFE_EVS_Register(NULL, 0, CFE_EVS_EventFilter_BINARY);
    CFE_MSG_Init(CFE_MSG_PTR(answer.header), CFE_SB_ValueToMsgId(@NAME@_COMMAND_MID), sizeof answer);
    if (CFE_SB_CreatePipe(&pipe, @NAME@_PIPE_DEPTH, "@NAME@_PIPE") != CFE_SUCCESS ||
        CFE_SB_Subscribe(CFE_SB_ValueToMsgId(@NAME@_MEASUREMENT_MID), pipe) != CFE_SUCCESS) {
        run = CFE_ES_RunStatus_APP_ERROR;
    }
    while (CFE_ES_RunLoop(&run)) {
        size_t size = 0;
        if (CFE_SB_ReceiveBuffer(&buffer, pipe, CFE_SB_PEND_FOREVER) != CFE_SUCCESS) {
            run = CFE_ES_RunStatus_APP_ERROR;
        } else if (CFE_MSG_GetSize(&buffer->Msg, &size) == CFE_SUCCESS && size == sizeof(@name@_measurement_message)) {
            take((const @name@_measurement_message *)buffer);
        }
    }
    CFE_ES_ExitApp(run);
}
