@name@_status @name@_step(
    @name@_controller *self,
    double time_s,
    @measurement@,
    @name@_command *out)
{
    int input;
    if (out == NULL) {
        return @NAME@_NULL_POINTER;
    }
    out->sent = 0U;
    if ((self == NULL) || @null_check@) {
        out->status = @NAME@_NULL_POINTER;
    } else {
        out->status = check_time(self, time_s);
    }
    if (out->status == @NAME@_NOMINAL) {
        out->status = check_measurement(@arguments@);
    }
    if (out->status == @NAME@_NOMINAL) {
        out->status = advance(self, time_s, @arguments@, &out->sent);
    }
    for (input = 0; input < INPUTS; ++input) {
        out->@input@[input] = (self != NULL) ? self->command[input] : 0.0;
    }
    return out->status;
}
