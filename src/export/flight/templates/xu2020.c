/* x'Wx with the trigger weight W; 0 is returned where it is not finite. */
static int quadratic_form(const double state[STATES], double *value)
{
    double product[STATES];
    int row;
    for (row = 0; row < STATES; ++row) {
        product[row] = sum_of_products(WEIGHT[row], state, STATES);
    }
    *value = sum_of_products(product, state, STATES);
    return (isfinite(*value) != 0) ? 1 : 0;
}

/* Whether the state must be sent: e'We >= threshold x(t_k)'W x(t_k) + floor, or nothing was sent before. 0 is returned where
 * that cannot be computed. */
static int decide(const @name@_controller *self, const double state[STATES], int *fires)
{
    double error[STATES];
    double form = 0.0;
    int index;
    if (self->has_sent == 0U) {
        *fires = 1;
        return quadratic_form(state, &form);
    }
    for (index = 0; index < STATES; ++index) {
        error[index] = state[index] - self->sent[index];
    }
    if (quadratic_form(error, &form) == 0) {
        return 0;
    }
    *fires = 0;
    if (form >= ((self->threshold * self->sent_form) + FLOOR)) {
        *fires = 1;
    }
    return 1;
}

/* The law u = sat(sum of the weighted gains times the state); 0 is returned, and nothing changed, where it overflows. */
static int apply_law(@name@_controller *self, const double state[STATES])
{
    double weights[GAINS];
    double command[INPUTS];
    int input;
    int rule;
    memberships(state, weights);
    for (input = 0; input < INPUTS; ++input) {
        command[input] = 0.0;
        for (rule = 0; rule < GAINS; ++rule) {
            command[input] += sum_of_products(GAIN[rule][input], state, STATES) * weights[rule];
        }
    }
    if (all_finite(command, INPUTS) == 0) {
        return 0;
    }
    saturate(command);
    for (input = 0; input < INPUTS; ++input) {
        self->command[input] = command[input];
    }
    return 1;
}

/* Remembers the state that was sent. */
static void record(@name@_controller *self, const double state[STATES])
{
    double form;
    int index;
    if (quadratic_form(state, &form) == 0) {
        return;
    }
    if (self->has_sent != 0U) {
        move_threshold(self, state);
    }
    for (index = 0; index < STATES; ++index) {
        self->sent[index] = state[index];
    }
    self->sent_form = form;
    self->has_sent = 1U;
}

/* How much longer an interval may be by rounding, over the time. */
static const double TIME_ROUNDING = 4.0 * DBL_EPSILON;

/* Whether the proof is about this sample. */
static @name@_status covered(const @name@_controller *self, double time_s, const double state[STATES])
{
    if (is_inside(state) == 0) {
        return @NAME@_OUTSIDE_BOX;
    }
    if ((self->has_time != 0U) && (((time_s - self->time_s) - LONGEST_INTERVAL_S) > (TIME_ROUNDING * fabs(time_s)))) {
        return @NAME@_LATE_SAMPLE;
    }
    return @NAME@_NOMINAL;
}

static @name@_status advance(
    @name@_controller *self,
    double time_s,
    @measurement@,
    uint8_t *sent)
{
    @name@_status status;
    double state[STATES];
    int fires = 0;
    read_state(@arguments@, state);
    if (decide(self, state, &fires) == 0) {
        return @NAME@_HELD_OVERFLOW;
    }
    if (fires != 0) {
        if (apply_law(self, state) == 0) {
            return @NAME@_HELD_OVERFLOW;
        }
        record(self, state);
        *sent = 1U;
    }
    status = covered(self, time_s, state);
    self->time_s = time_s;
    self->has_time = 1U;
    return status;
}

void @name@_init(@name@_controller *self)
{
    int index;
    if (self == NULL) {
        return;
    }
    for (index = 0; index < INPUTS; ++index) {
        self->command[index] = 0.0;
    }
    for (index = 0; index < STATES; ++index) {
        self->sent[index] = 0.0;
    }
    self->sent_form = 0.0;
    self->threshold = FIRST_THRESHOLD;
    self->time_s = 0.0;
    self->has_time = 0U;
    self->has_sent = 0U;
}
