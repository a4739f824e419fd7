/* For kinds of variables that there are none of: an error unless nothing is asked for. */
static fmi2Status none(const instance *self, size_t count)
{
    if (self == NULL) {
        return fmi2Error;
    }
    return (count == 0U) ? fmi2OK : report(self, fmi2Error, "there are no variables of this kind");
}

EXPORTED fmi2Status FMI(fmi2GetString)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2String values[])
{
    (void)references;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2SetInteger)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Integer values[])
{
    (void)references;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2SetBoolean)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2Boolean values[])
{
    (void)references;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2SetString)(
    fmi2Component component, const fmi2ValueReference references[], size_t count, const fmi2String values[])
{
    (void)references;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2SetRealInputDerivatives)(
    fmi2Component component,
    const fmi2ValueReference references[],
    size_t count,
    const fmi2Integer orders[],
    const fmi2Real values[])
{
    (void)references;
    (void)orders;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2GetRealOutputDerivatives)(
    fmi2Component component,
    const fmi2ValueReference references[],
    size_t count,
    const fmi2Integer orders[],
    fmi2Real values[])
{
    (void)references;
    (void)orders;
    (void)values;
    return none(component, count);
}

EXPORTED fmi2Status FMI(fmi2GetDirectionalDerivative)(
    fmi2Component component,
    const fmi2ValueReference unknowns[],
    size_t unknown_count,
    const fmi2ValueReference knowns[],
    size_t known_count,
    const fmi2Real given[],
    fmi2Real found[])
{
    (void)unknowns;
    (void)knowns;
    (void)known_count;
    (void)given;
    (void)found;
    return none(component, unknown_count);
}

EXPORTED fmi2Status FMI(fmi2GetFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    instance *self = component;
    if ((self == NULL) || (state == NULL)) {
        return fmi2Error;
    }
    if (*state == NULL) {
        *state = self->callbacks.allocateMemory(1U, sizeof self->now);
    }
    if (*state == NULL) {
        return report(self, fmi2Error, "there is no memory left");
    }
    (void)memcpy(*state, &self->now, sizeof self->now);
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2SetFMUstate)(fmi2Component component, fmi2FMUstate state)
{
    instance *self = component;
    if ((self == NULL) || (state == NULL)) {
        return fmi2Error;
    }
    (void)memcpy(&self->now, state, sizeof self->now);
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2FreeFMUstate)(fmi2Component component, fmi2FMUstate *state)
{
    instance *self = component;
    if (self == NULL) {
        return fmi2Error;
    }
    if ((state != NULL) && (*state != NULL)) {
        self->callbacks.freeMemory(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2SerializedFMUstateSize)(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    (void)state;
    if ((component == NULL) || (size == NULL)) {
        return fmi2Error;
    }
    *size = sizeof(condition);
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2SerializeFMUstate)(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    instance *self = component;
    if ((self == NULL) || (state == NULL) || (bytes == NULL)) {
        return fmi2Error;
    }
    if (size < sizeof(condition)) {
        return report(self, fmi2Error, "there is too little room for the state");
    }
    (void)memcpy(bytes, state, sizeof(condition));
    return fmi2OK;
}

/* The bytes are those of this program on this machine, and are of use to no other. */
EXPORTED fmi2Status FMI(fmi2DeSerializeFMUstate)(
    fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    instance *self = component;
    if ((self == NULL) || (bytes == NULL) || (state == NULL)) {
        return fmi2Error;
    }
    if (size != sizeof(condition)) {
        return report(self, fmi2Error, "these bytes are no state of this FMU");
    }
    if (*state == NULL) {
        *state = self->callbacks.allocateMemory(1U, sizeof(condition));
    }
    if (*state == NULL) {
        return report(self, fmi2Error, "there is no memory left");
    }
    (void)memcpy(*state, bytes, sizeof(condition));
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2CancelStep)(fmi2Component component)
{
    return (component == NULL) ? fmi2Error : report(component, fmi2Error, "no step is pending");
}

EXPORTED fmi2Status FMI(fmi2GetStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind;
    (void)value;
    return (component == NULL) ? fmi2Error : fmi2Discard;
}

EXPORTED fmi2Status FMI(fmi2GetRealStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value)
{
    const instance *self = component;
    if ((self == NULL) || (value == NULL)) {
        return fmi2Error;
    }
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = self->now.last_s;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2GetIntegerStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind;
    (void)value;
    return (component == NULL) ? fmi2Error : fmi2Discard;
}

EXPORTED fmi2Status FMI(fmi2GetBooleanStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if ((component == NULL) || (value == NULL)) {
        return fmi2Error;
    }
    if (kind != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = 0;
    return fmi2OK;
}

EXPORTED fmi2Status FMI(fmi2GetStringStatus)(fmi2Component component, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind;
    (void)value;
    return (component == NULL) ? fmi2Error : fmi2Discard;
}
