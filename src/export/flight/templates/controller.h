#ifndef STEADFAST_@NAME@_H
#define STEADFAST_@NAME@_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* 1 where the check proved every condition of this controller when it was written, else 0. */
#define @NAME@_PROVED @proved@
@sizes@
/* How often each message is sent again, at the samples that follow. */
#define @NAME@_REPEATS @repeats@U

/* What a step says of its sample. */
typedef enum {
    @NAME@_NOMINAL = 0,                    /* used */
    @NAME@_OUTSIDE_BOX = 1,                /* used; the state is outside of the set that the proof is about */
    @NAME@_LATE_SAMPLE = 2,                /* used; the sample is later than the proof allows */
    @NAME@_HELD_TIME_NOT_FINITE = 3,       /* not used: the command in force is held, as in all that follow */
    @NAME@_HELD_TIME_NOT_INCREASING = 4,   /* the time is not later than that of the last sample used */
    @NAME@_HELD_MEASUREMENT_NOT_FINITE = 5,
    @NAME@_HELD_NOT_UNIT_QUATERNION = 6,   /* the norm of the quaternion is more than 0.01 from 1 */
    @NAME@_HELD_OVERFLOW = 7,              /* too large to compute with */
    @NAME@_NULL_POINTER = 8                /* not used */
} @name@_status;

@types@/* The controller between samples. The caller owns it; its fields are not for the caller. */
typedef struct {
@fields@
} @name@_controller;

/* The result of a step. */
typedef struct {
    double @input@[@NAME@_INPUTS];         /* @input_meaning@; finite and within the limits, zero before the first sample used */
    uint8_t sent;                          /* @sent_meaning@ */
    @name@_status status;
} @name@_command;

/* A command on its way over a network that may lose or delay it. */
typedef struct {
    uint32_t number;                       /* the same for all repetitions of a command */
    double @input@[@NAME@_INPUTS];
} @name@_message;

/* The sender's end. */
typedef struct {
    uint32_t next;
    uint32_t remaining;
    uint8_t has_message;
    @name@_message message;
} @name@_sender;

/* The receiver's end. */
typedef struct {
    uint8_t has_message;
    @name@_message message;
} @name@_receiver;

/* What an arriving message was. */
typedef enum {
    @NAME@_NEW = 0,                        /* newer than anything before: in force from now on */
    @NAME@_REPEATED = 1,                   /* a repetition of the command in force */
    @NAME@_OLD = 2                         /* overtaken by a newer one; dropped */
} @name@_arrival;

/* Makes the controller one before its first sample, with a command of zero. */
void @name@_init(@name@_controller *self);

/* The same, later: the way on after a time stamp that was finite but wrong and far in the future. */
void @name@_reset(@name@_controller *self);

/* Takes the sample at a time (s). @sending@
@measurement_meaning@
 * out: the command, filled in unless it is null itself: of a null controller zero, of a null measurement the command in
 * force. Returns its status. */
@name@_status @name@_step(
    @name@_controller *self,
    double time_s,
    @measurement@,
    @name@_command *out);

@functions@/* The largest magnitude of an input; 0 where there is no such input. */
double @name@_limit(int input);

/* Nothing was sent yet; the number of the first message. */
void @name@_sender_init(@name@_sender *self, uint32_t first_number);

/* Called once after each step. Returns 1 and the message where one is to be transmitted at this sample, else 0. */
int @name@_sender_sample(@name@_sender *self, const @name@_command *command, @name@_message *out);

/* Nothing has arrived yet. */
void @name@_receiver_init(@name@_receiver *self);

/* Takes a message that has arrived. */
@name@_arrival @name@_receiver_take(@name@_receiver *self, const @name@_message *message);

/* The command in force at the receiver's end, zero before the first arrival. */
void @name@_receiver_command(const @name@_receiver *self, double command[@NAME@_INPUTS]);

#ifdef __cplusplus
}
#endif

#endif
