void @name@_reset(@name@_controller *self)
{
    @name@_init(self);
}

double @name@_limit(int input)
{
    return ((input >= 0) && (input < INPUTS)) ? LIMITS[input] : 0.0;
}

void @name@_sender_init(@name@_sender *self, uint32_t first_number)
{
    int input;
    if (self == NULL) {
        return;
    }
    self->next = first_number;
    self->remaining = 0U;
    self->has_message = 0U;
    self->message.number = first_number;
    for (input = 0; input < INPUTS; ++input) {
        self->message.@input@[input] = 0.0;
    }
}

int @name@_sender_sample(@name@_sender *self, const @name@_command *command, @name@_message *out)
{
    int input;
    if ((self == NULL) || (command == NULL) || (out == NULL)) {
        return 0;
    }
    if (command->sent != 0U) {
        self->message.number = self->next;
        for (input = 0; input < INPUTS; ++input) {
            self->message.@input@[input] = command->@input@[input];
        }
        self->next = (self->next + 1U) & 0xFFFFFFFFU;
        self->remaining = @NAME@_REPEATS;
        self->has_message = 1U;
    } else if ((self->has_message != 0U) && (self->remaining > 0U)) {
        self->remaining -= 1U;
    } else {
        return 0;
    }
    *out = self->message;
    return 1;
}

void @name@_receiver_init(@name@_receiver *self)
{
    int input;
    if (self == NULL) {
        return;
    }
    self->has_message = 0U;
    self->message.number = 0U;
    for (input = 0; input < INPUTS; ++input) {
        self->message.@input@[input] = 0.0;
    }
}

@name@_arrival @name@_receiver_take(@name@_receiver *self, const @name@_message *message)
{
    if ((self == NULL) || (message == NULL)) {
        return @NAME@_OLD;
    }
    if (self->has_message != 0U) {
        const uint32_t ahead = (message->number - self->message.number) & 0xFFFFFFFFU;
        if (ahead == 0U) {
            return @NAME@_REPEATED;
        }
        if (ahead >= 0x80000000U) {
            return @NAME@_OLD;
        }
    }
    self->message = *message;
    self->has_message = 1U;
    return @NAME@_NEW;
}

void @name@_receiver_command(const @name@_receiver *self, double command[@NAME@_INPUTS])
{
    int input;
    if ((self == NULL) || (command == NULL)) {
        return;
    }
    for (input = 0; input < INPUTS; ++input) {
        command[input] = self->message.@input@[input];
    }
}
