@name@_status @name@_step(
    @name@_controller *self,
    double time_s,
    @measurement@,
    @name@_command *out)
{
    int input;
    if ((self == NULL) || @null_check@ || (out == NULL)) {
        return @NAME@_NULL_POINTER;
    }
    out->sent = 0U;
    out->status = check_time(self, time_s);
    if (out->status == @NAME@_NOMINAL) {
        out->status = check_measurement(@arguments@);
    }
    if (out->status == @NAME@_NOMINAL) {
        out->status = advance(self, time_s, @arguments@, &out->sent);
    }
    for (input = 0; input < INPUTS; ++input) {
        out->@input@[input] = self->command[input];
    }
    return out->status;
}
