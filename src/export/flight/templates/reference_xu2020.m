function reference = @name@_reference()
% The law of the controller '@name@' to read and to try, without a compiler.
%
%   reference = @name@_reference();
%   self = reference.init();
%   [self, command, sent, status] = reference.step(self, time_s, @arguments@);
%
% u = sat(F x(t_k)), F the blend of the gains at the state x(t_k) that was sent last. A state is sent when
% e' W e >= threshold * x(t_k)' W x(t_k) + floor with e = x - x(t_k); the first one always is.
% status: as in @name@.h. Units: those of the design, for a spacecraft rad/s and N m, quaternions scalar part first.
%
% Every sum is formed in the order of the C code, so its results have the same bits.
%
% @about_file@

    c = constants();
    reference.limits = c.LIMITS;
    reference.init = @() init(c);
    reference.step = @(self, time_s, varargin) step(c, self, time_s, varargin{:});
end

function c = constants()
@constants_m@
end

% A controller before its first sample.
function self = init(c)
    self.command = zeros(numel(c.LIMITS), 1);
    self.sent = [];
    self.sent_form = 0;
    self.threshold = c.FIRST_THRESHOLD;
    self.time_s = [];
end

% One sample.
function [self, command, sent, status] = step(c, self, time_s, varargin)
    sent = false;
    status = check_time(self, time_s);
    if status == 0
        [state, status] = read_state(varargin{:});
    end
    if status == 0
        [self, sent, status] = advance(c, self, time_s, state);
    end
    command = self.command;
end

% The state itself, or that of an error quaternion and a rate: the rate, then the vector part of the quaternion whose scalar
% part is not negative. Refuses what is not finite (5) or not a unit quaternion (6).
function [state, status] = read_state(measured, rate_rad_s)
    status = 0;
    if nargin == 1
        state = measured(:);
        if ~all(isfinite(state))
            status = 5;
        end
        return
    end
    vector = reshape(measured(2:4), 3, 1);
    if measured(1) < 0
        vector = -vector;
    end
    state = [rate_rad_s(:); vector];
    if ~all(isfinite([measured(:); rate_rad_s(:)]))
        status = 5;
    elseif ~(abs(sqrt(measured(1) * measured(1) + products(vector, vector)) - 1) <= 1e-2)
        status = 6;
    end
end

% The trigger and, where it fires, the law. Status 7: too large to compute with.
function [self, sent, status] = advance(c, self, time_s, state)
    sent = false;
    [fires, finite] = decide(c, self, state);
    if ~finite
        status = 7;
        return
    end
    if fires
        command = law(c, state);
        if ~all(isfinite(command))
            status = 7;
            return
        end
        self.command = command;
        self = record(c, self, state);
        sent = true;
    end
    status = covered(c, self, time_s, state);
    self.time_s = time_s;
end

% Whether the state must be sent.
function [fires, finite] = decide(c, self, state)
    if isempty(self.sent)
        fires = true;
        finite = isfinite(form(c, state));
        return
    end
    error_form = form(c, state - self.sent);
    finite = isfinite(error_form);
    fires = error_form >= self.threshold * self.sent_form + c.FLOOR;
end

% Remembers the state that was sent.
function self = record(c, self, state)
    state_form = form(c, state);
    if ~isfinite(state_form)
        return
    end
    if ~isempty(self.sent)
        self.threshold = moved_threshold(c, self, state);
    end
    self.sent = state;
    self.sent_form = state_form;
end

% The threshold after a trigger at which the sent state moved; most designs keep it.
function threshold = moved_threshold(c, self, state)
    threshold = self.threshold;
    if isfield(c, 'AMPLITUDE')
        moved = sqrt(products(state - self.sent, state - self.sent));
        threshold = threshold * (1 - c.AMPLITUDE * atan(c.SLOPE * (moved - c.DEAD_BAND)));
        threshold = smaller(larger(threshold, c.LEAST_THRESHOLD), c.LARGEST_THRESHOLD);
    end
end

% u = sat(sum of the weighted gains times the state).
function command = law(c, state)
    weights = memberships(c, state);
    command = zeros(numel(c.LIMITS), 1);
    for input = 1:numel(command)
        for rule = 1:c.GAINS
            command(input) = command(input) + products(c.GAIN(input, :, rule), state) * weights(rule);
        end
        if isfinite(command(input))
            command(input) = larger(smaller(command(input), c.LIMITS(input)), -c.LIMITS(input));
        end
    end
end

% The weights of the gains: one; of the corners of a box; or of rules with fuzzy sets.
function weights = memberships(c, state)
    if c.GAINS == 1
        weights = 1;
    elseif isfield(c, 'SETS')
        weights = weights_of_rules(c, state);
    else
        weights = weights_of_corners(c, state);
    end
end

% Outside of the box those of its nearest point.
function weights = weights_of_corners(c, state)
    variables = scheduling_variables(state);
    weights = ones(c.GAINS, 1);
    for index = 1:4
        part = (variables(index) - c.LOWER(index)) / (c.UPPER(index) - c.LOWER(index));
        upper = smaller(larger(part, 0), 1);
        for rule = 1:c.GAINS
            if bitget(rule - 1, index)
                weights(rule) = weights(rule) * upper;
            else
                weights(rule) = weights(rule) * (1 - upper);
            end
        end
    end
end

% Products of grades, scaled to the sum 1; outside of the box those of its nearest point.
function weights = weights_of_rules(c, state)
    weights = ones(c.GAINS, 1);
    exponents = zeros(c.GAINS, 1);
    for rule = 1:c.GAINS
        for index = 1:numel(state)
            inside = smaller(larger(state(index), -c.BOUNDS(index)), c.BOUNDS(index));
            [factor, exponent] = grade(c.SETS(index, :, rule), inside);
            weights(rule) = weights(rule) * factor;
            exponents(rule) = exponents(rule) + exponent;
        end
    end
    applies = weights > 0;
    total = 0;
    if any(applies)
        nearest = min(exponents(applies));
        for rule = 1:c.GAINS
            if applies(rule)
                weights(rule) = weights(rule) * exp(nearest - exponents(rule));
            end
            total = total + weights(rule);
        end
    end
    if total > 0 && isfinite(total)
        weights = weights / total;
    else
        weights(:) = c.EQUAL_WEIGHT;
    end
end

% The grade factor * exp(-exponent) of a value in a fuzzy set: 0 any, 1 and 2 straight sides (left, left top, right top,
% right), 3 Gaussian (centre, width), 4 never.
function [factor, exponent] = grade(set, value)
    factor = 0;
    exponent = 0;
    kind = set(1);
    if kind == 0
        factor = 1;
    elseif kind == 3
        offset = (value - set(2)) / set(3);
        exponent = 0.5 * offset * offset;
        factor = 1;
    elseif kind < 3
        if set(3) <= value && value <= set(4)
            factor = 1;
        elseif set(2) < value && value < set(3)
            factor = (value - set(2)) / (set(3) - set(2));
        elseif set(4) < value && value < set(5)
            factor = (set(5) - value) / (set(5) - set(4));
        end
    end
end

% The three rates (rad/s) and the scalar part of the quaternion.
function variables = scheduling_variables(state)
    variables = [state(1:3); sqrt(larger(1 - products(state(4:6), state(4:6)), 0))];
end

% Whether the proof is about this sample: 1 outside of its set, 2 later than it allows.
function status = covered(c, self, time_s, state)
    status = 0;
    if ~is_inside(c, state)
        status = 1;
    elseif ~isempty(self.time_s) && (time_s - self.time_s) - c.LONGEST_INTERVAL_S > 4 * eps * abs(time_s)
        status = 2;
    end
end

function inside = is_inside(c, state)
    inside = true;
    if isfield(c, 'LOWER')
        variables = scheduling_variables(state);
        inside = all(variables >= c.LOWER(:)) && all(variables <= c.UPPER(:)) && products(state(4:6), state(4:6)) <= 1;
    elseif isfield(c, 'BOUNDS')
        inside = all(abs(state) <= c.BOUNDS(:));
    end
end

% x' W x with the trigger weight W.
function value = form(c, x)
    product = zeros(numel(x), 1);
    for row = 1:numel(x)
        product(row) = products(c.WEIGHT(row, :), x);
    end
    value = products(product, x);
end
