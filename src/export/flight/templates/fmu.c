#include "@name@.h"

#include <stddef.h>
#include <string.h>

/*
 * The controller as a co-simulation FMU of FMI 2.0 (fmi-standard.org). Nothing but this file, @name@.h and @name@.c is
 * needed to build it: what the standard's headers declare is declared below, as far as it is used.
 *
 * Each fmi2DoStep takes one sample, at the communication point (s) at which it begins, so the communication step is the
 * sampling interval. Outputs that are asked for after inputs were set are those of the sample that is due now; a master
 * that asks for them before it steps the plant delays nothing. After fmi2DoStep, until inputs are set, they are those of
 * the sample that it took.
 *
 * The functions have the plain names that a shared library needs. Where several FMUs are linked into one program,
 * compile with -DFMI2_FUNCTION_PREFIX=@name@_, which every function then begins with.
 */
#if defined(FMI2_FUNCTION_PREFIX)
#define JOINED(prefix, function) prefix##function
#define JOIN(prefix, function) JOINED(prefix, function)
#define FMI(function) JOIN(FMI2_FUNCTION_PREFIX, function)
#else
#define FMI(function) function
#endif

#if defined(_WIN32) || defined(__CYGWIN__)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

/* Types of the standard; its enumerations count from 0. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

/* The same as in modelDescription.xml. */
#define GUID "@guid@"
#define GIVEN @given@                  /* numbers of a measurement: the real inputs with the references from 0 */
#define FIRST_COMMAND 1000U            /* reference of the first command */
#define STATUS 0U                      /* references of the integers */
#define MESSAGES 1U
#define SENT 0U                        /* reference of the boolean */

#define LONGEST_NAME 128
#define MOST_MESSAGES 0x7FFFFFFF

typedef enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8 } mode;

/* All that a step changes: saved and restored as a whole. */
typedef struct {
    @name@_controller controller;
    @name@_command command;            /* of the last sample taken, or of the one that is due */
    double row[1 + GIVEN];             /* the time now (s), then the measurement */
    double last_s;                     /* end of the last step (s) */
    fmi2Integer messages;              /* sent until the last sample taken */
    fmi2Integer messages_shown;        /* the same with the sample of the command */
    uint8_t is_due;                    /* 1 when inputs were set, and the command is not theirs yet */
    uint8_t mode;
} condition;

typedef struct {
    condition now;
    fmi2CallbackFunctions callbacks;
    fmi2Boolean logging;
    char name[LONGEST_NAME];
} instance;

/* Logs what went wrong, and returns its status. */
static fmi2Status report(const instance *self, fmi2Status status, const char *message)
{
    const char *category = (status == fmi2Warning) ? "logStatusWarning" : "logStatusError";
    if ((self->callbacks.logger != NULL) && ((status != fmi2Warning) || (self->logging != 0))) {
        self->callbacks.logger(self->callbacks.componentEnvironment, self->name, status, category, message);
    }
    return status;
}

/* Whether a function may be called now. */
static int is_allowed(const instance *self, unsigned modes)
{
    if (self == NULL) {
        return 0;
    }
    if (((unsigned)self->now.mode & modes) == 0U) {
        (void)report(self, fmi2Error, "this function may not be called now");
        return 0;
    }
    return 1;
}

/* Before the first sample, with no rate or state and no attitude error. */
static void begin(condition *now)
{
    (void)memset(now, 0, sizeof *now);
    @name@_init(&now->controller);
    now->row[1] = @first_input@;
    now->mode = (uint8_t)INSTANTIATED;
}

/* The sample at the time row[0] (s) with the present inputs, by a controller that is not the instance's own yet. */
static void sample(condition *now, @name@_controller *controller)
{
    const double *row = now->row;
    (void)@name@_step(controller, row[0], @from_row@, &now->command);
    now->messages_shown = now->messages;
    if ((now->command.sent != 0U) && (now->messages < MOST_MESSAGES)) {
        now->messages_shown += 1;
    }
    now->is_due = 0U;
}

/* Outputs after inputs were set: those of the sample that is due, which is not taken yet. */
static void look_ahead(condition *now)
{
    if (now->is_due != 0U) {
        @name@_controller tried = now->controller;
        sample(now, &tried);
    }
}

EXPORTED const char *FMI(fmi2GetTypesPlatform)(void)
{
    return "default";
}

EXPORTED const char *FMI(fmi2GetVersion)(void)
{
    return "2.0";
}

EXPORTED fmi2Status FMI(fmi2SetDebugLogging)(
    fmi2Component component, fmi2Boolean on, size_t count, const fmi2String categories[])
{
    instance *self = component;
    (void)count;
    (void)categories;
    if (self == NULL) {
        return fmi2Error;
    }
    self->logging = on;
    return fmi2OK;
}

EXPORTED fmi2Component FMI(fmi2Instantiate)(
    fmi2String name,
    fmi2Type type,
    fmi2String guid,
    fmi2String resources,
    const fmi2CallbackFunctions *callbacks,
    fmi2Boolean visible,
    fmi2Boolean logging)
{
    instance *self;
    (void)resources;
    (void)visible;
    if ((name == NULL) || (guid == NULL) || (callbacks == NULL) || (callbacks->allocateMemory == NULL) ||
        (callbacks->freeMemory == NULL)) {
        return NULL;
    }
    self = callbacks->allocateMemory(1U, sizeof *self);
    if (self == NULL) {
        return NULL;
    }
    self->callbacks = *callbacks;
    self->logging = logging;
    self->name[0] = '\0';
    (void)strncat(self->name, name, sizeof self->name - 1U);
    begin(&self->now);
    if ((type != fmi2CoSimulation) || (strcmp(guid, GUID) != 0)) {
        (void)report(self, fmi2Error, "this FMU is for co-simulation, and its guid is " GUID);
        callbacks->freeMemory(self);
        return NULL;
    }
    return self;
}

EXPORTED void FMI(fmi2FreeInstance)(fmi2Component component)
{
    instance *self = component;
    if (self != NULL) {
        self->callbacks.freeMemory(self);
    }
}

EXPORTED fmi2Status FMI(fmi2SetupExperiment)(
    fmi2Component component,
    fmi2Boolean has_tolerance,
    fmi2Real tolerance,
    fmi2Real start,
    fmi2Boolean has_stop,
    fmi2Real stop)
{
    instance *self = component;
    (void)has_tolerance;
    (void)tolerance;
    (void)has_stop;
    (void)stop;
    if (is_allowed(self, INSTANTIATED) == 0) {
        return fmi2Error;
    }
    self->now.row[0] = start;
    self->now.last_s = start;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2EnterInitializationMode)(fmi2Component component)
{
    instance *self = component;
    if (is_allowed(self, INSTANTIATED) == 0) {
        return fmi2Error;
    }
    self->now.mode = (uint8_t)INITIALIZING;
    self->now.is_due = 1U;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2ExitInitializationMode)(fmi2Component component)
{
    instance *self = component;
    if (is_allowed(self, INITIALIZING) == 0) {
        return fmi2Error;
    }
    self->now.mode = (uint8_t)STEPPING;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2Terminate)(fmi2Component component)
{
    instance *self = component;
    if (is_allowed(self, STEPPING) == 0) {
        return fmi2Error;
    }
    self->now.mode = (uint8_t)TERMINATED;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2Reset)(fmi2Component component)
{
    instance *self = component;
    if (self == NULL) {
        return fmi2Error;
    }
    begin(&self->now);
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2SetReal)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Real values[])
{
    instance *self = component;
    size_t index;
    if (is_allowed(self, INSTANTIATED | INITIALIZING | STEPPING) == 0) {
        return fmi2Error;
    }
    for (index = 0U; index < count; ++index) {
        if (references[index] >= GIVEN) {
            return report(self, fmi2Error, "there is no real input with this value reference");
        }
        self->now.row[1U + references[index]] = values[index];
    }
    self->now.is_due = 1U;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2GetReal)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[])
{
    instance *self = component;
    size_t index;
    if (is_allowed(self, INITIALIZING | STEPPING | TERMINATED) == 0) {
        return fmi2Error;
    }
    look_ahead(&self->now);
    for (index = 0U; index < count; ++index) {
        const fmi2ValueReference reference = references[index];
        if (reference < GIVEN) {
            values[index] = self->now.row[1U + reference];
        } else if ((reference >= FIRST_COMMAND) && (reference < (FIRST_COMMAND + @NAME@_INPUTS))) {
            values[index] = self->now.command.@input@[reference - FIRST_COMMAND];
        } else {
            return report(self, fmi2Error, "there is no real variable with this value reference");
        }
    }
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2GetInteger)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Integer values[])
{
    instance *self = component;
    size_t index;
    if (is_allowed(self, INITIALIZING | STEPPING | TERMINATED) == 0) {
        return fmi2Error;
    }
    look_ahead(&self->now);
    for (index = 0U; index < count; ++index) {
        if (references[index] == STATUS) {
            values[index] = (fmi2Integer)self->now.command.status;
        } else if (references[index] == MESSAGES) {
            values[index] = self->now.messages_shown;
        } else {
            return report(self, fmi2Error, "there is no integer with this value reference");
        }
    }
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2GetBoolean)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Boolean values[])
{
    instance *self = component;
    size_t index;
    if (is_allowed(self, INITIALIZING | STEPPING | TERMINATED) == 0) {
        return fmi2Error;
    }
    look_ahead(&self->now);
    for (index = 0U; index < count; ++index) {
        if (references[index] != SENT) {
            return report(self, fmi2Error, "there is no boolean with this value reference");
        }
        values[index] = (fmi2Boolean)self->now.command.sent;
    }
    return fmi2OK;
}

/* What is to be said of a sample. */
static fmi2Status judged(const instance *self)
{
    switch (self->now.command.status) {
    case @NAME@_HELD_TIME_NOT_FINITE:
        return report(self, fmi2Error, "the time is not finite");
    case @NAME@_HELD_TIME_NOT_INCREASING:
        return report(self, fmi2Error, "the time is not later than that of the last sample used");
    case @NAME@_HELD_MEASUREMENT_NOT_FINITE:
        return report(self, fmi2Warning, "the measurement is not finite: the command is held");
    case @NAME@_HELD_NOT_UNIT_QUATERNION:
        return report(self, fmi2Warning, "the norm of the quaternion is not 1: the command is held");
    case @NAME@_HELD_OVERFLOW:
        return report(self, fmi2Warning, "the measurement is too large to compute with: the command is held");
    case @NAME@_NULL_POINTER:
        return report(self, fmi2Error, "nothing was done");
    case @NAME@_NOMINAL:
    case @NAME@_OUTSIDE_BOX:
    case @NAME@_LATE_SAMPLE:
    default:
        return fmi2OK;
    }
}

EXPORTED fmi2Status FMI(fmi2DoStep)(
    fmi2Component component, fmi2Real point, fmi2Real step, fmi2Boolean no_way_back)
{
    instance *self = component;
    fmi2Status status;
    (void)no_way_back;
    if (is_allowed(self, STEPPING) == 0) {
        return fmi2Error;
    }
    if (!(step > 0.0)) {
        return report(self, fmi2Error, "the communication step is not positive");
    }
    self->now.row[0] = point;
    sample(&self->now, &self->now.controller);
    self->now.messages = self->now.messages_shown;
    self->now.row[0] = point + step;
    status = judged(self);
    if (status != fmi2Error) {
        self->now.last_s = self->now.row[0];
    }
    return status;
}
