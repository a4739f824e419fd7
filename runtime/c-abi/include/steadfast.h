/*
 * The controllers of the Rust crate steadfast-runtime, linked as the static library libsteadfast.a.
 *
 * SI units and radians; quaternions with the scalar part first. No allocation, no panic, bounded time. A structure is the
 * caller's; it must have been given to its init function, with the return value 0, before any other function. Structures are
 * independent of each other.
 */
#ifndef STEADFAST_H
#define STEADFAST_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a function returns, and what a step says of its sample. */
enum {
    STEADFAST_NOMINAL = 0,                    /* used, done */
    STEADFAST_OUTSIDE_BOX = 1,                /* used; the state is outside of the set that the proof is about */
    STEADFAST_LATE_SAMPLE = 2,                /* used; the sample is later than the proof allows */
    STEADFAST_HELD_TIME_NOT_FINITE = 3,       /* not used: the command in force is held, as in all that follow */
    STEADFAST_HELD_TIME_NOT_INCREASING = 4,
    STEADFAST_HELD_MEASUREMENT_NOT_FINITE = 5,
    STEADFAST_HELD_NOT_UNIT_QUATERNION = 6,
    STEADFAST_HELD_OVERFLOW = 7,
    STEADFAST_NULL_POINTER = 8,               /* nothing was done */
    STEADFAST_BAD_PARAMETERS = 9              /* a parameter is not finite or out of its range; nothing was done */
};

/* The result of a step. */
typedef struct {
    double torque_nm[3]; /* about the body axes (N m) */
    uint8_t sent;        /* 1 where the trigger fired */
    int32_t status;
} steadfast_command;

/* A design with one gain: Xu and Huang 2020, (10) and (12). Names as in a design file. */
typedef struct {
    double gain[3][6];            /* columns: rate (N m s/rad), vector part (N m) */
    double trigger_weight[6][6];  /* Upsilon, symmetric, positive definite */
    double trigger_floor;         /* eps_a, 0 or above */
    double threshold;             /* nu, in [0, 1): the largest */
    double least_threshold;       /* nu_min, the first; not used where mu is 0 */
    double mu[3];                 /* amplitude, slope, dead band of the threshold's update; all 0: the threshold is fixed */
    double torque_limit_nm[3];    /* above 0 (N m) */
    double rate_bound_rad_s[3];   /* the box of the model, above 0 (rad/s) */
    double least_scalar_part;     /* q0_min of the box, in [0, 1) */
    double longest_interval_s;    /* hbar, above 0 (s) */
} steadfast_xu2020_parameters;

/* Wu, Shen and Cao 2018, (6) and (8). */
typedef struct {
    double error_gain_nm_s_rad;   /* k, above 0 */
    double attitude_weight_rad_s; /* beta, above 0 */
    double relative;              /* alpha, in (0, 1) */
    double absolute_rad_s;        /* gamma, above 0 */
    double torque_limit_nm[3];    /* above 0 (N m) */
    double hysteresis;            /* of the shortest rotation, in [0, 1); below 0: always to scalar part +1, as published */
} steadfast_wu2018_parameters;

/* A controller between samples; its contents are not for the caller. */
typedef struct {
    uint64_t opaque[100];
} steadfast_xu2020;

typedef struct {
    uint64_t opaque[40];
} steadfast_wu2018;

int32_t steadfast_xu2020_init(steadfast_xu2020 *controller, const steadfast_xu2020_parameters *parameters);
int32_t steadfast_xu2020_step(
    steadfast_xu2020 *controller,
    double time_s,
    const double error_quaternion[4],
    const double rate_rad_s[3],
    steadfast_command *out);
int32_t steadfast_xu2020_reset(steadfast_xu2020 *controller);

int32_t steadfast_wu2018_init(steadfast_wu2018 *controller, const steadfast_wu2018_parameters *parameters);
int32_t steadfast_wu2018_step(
    steadfast_wu2018 *controller,
    double time_s,
    const double error_quaternion[4],
    const double rate_rad_s[3],
    steadfast_command *out);
int32_t steadfast_wu2018_reset(steadfast_wu2018 *controller);

#ifdef __cplusplus
}
#endif

#endif
