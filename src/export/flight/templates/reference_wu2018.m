function reference = @name@_reference()
% The law of the controller '@name@' to read and to try, without a compiler.
%
%   reference = @name@_reference();
%   self = reference.init();
%   [self, command, sent, status] = reference.step(self, time_s, @arguments@);
%
% u = sat(-k s(t_k)) with the filtered error s = rate + beta * vector part (rad/s) that was sent last. It is sent when
% |s(t_k) - s| >= alpha |s| + gamma; the first one always is.
% status: as in @name@.h. Units: rad/s, N m, quaternions with the scalar part first.
%
% Every sum is formed in the order of the C code, so its results have the same bits.
%
% @about_file@

    c = constants();
    reference.limits = c.LIMITS;
    reference.init = @init;
    reference.step = @(self, time_s, varargin) step(c, self, time_s, varargin{:});
end

function c = constants()
@constants_m@
end

% A controller before its first sample.
function self = init()
    self.command = zeros(3, 1);
    self.sent = [];
    self.time_s = [];
    self.is_positive = [];
end

% One sample.
function [self, command, sent, status] = step(c, self, time_s, error_quaternion, rate_rad_s)
    sent = false;
    status = check_time(self, time_s);
    if status == 0
        status = check_attitude(error_quaternion, rate_rad_s);
    end
    if status == 0
        [self, sent, status] = advance(c, self, time_s, error_quaternion(:), rate_rad_s(:));
    end
    command = self.command;
end

% Refuses a measurement that is not finite (5) or whose quaternion is no attitude (6).
function status = check_attitude(quaternion, rate_rad_s)
    status = 0;
    if ~all(isfinite([quaternion(:); rate_rad_s(:)]))
        status = 5;
    elseif ~(abs(sqrt(quaternion(1) * quaternion(1) + products(quaternion(2:4), quaternion(2:4))) - 1) <= 1e-2)
        status = 6;
    end
end

% The trigger and, where it fires, the law. Status 7: too large to compute with.
function [self, sent, status] = advance(c, self, time_s, quaternion, rate_rad_s)
    sent = false;
    status = 0;
    positive = side_is_positive(c, self, quaternion(1));
    weight = c.ATTITUDE_WEIGHT;
    if ~positive
        weight = -weight;
    end
    filtered = rate_rad_s + quaternion(2:4) * weight;
    if ~all(isfinite(filtered))
        status = 7;
        return
    end
    self.is_positive = positive;
    self.time_s = time_s;
    if fires(c, self, filtered)
        self.sent = filtered;
        for axis = 1:3
            self.command(axis) = larger(smaller(filtered(axis) * -c.ERROR_GAIN, c.LIMITS(axis)), -c.LIMITS(axis));
        end
        sent = true;
    end
end

% The sign with which the vector part enters; it changes only when the scalar part has passed zero by the hysteresis.
function positive = side_is_positive(c, self, scalar)
    if c.SHORTEST == 0
        positive = true;
    elseif isempty(self.is_positive)
        positive = scalar >= 0;
    elseif self.is_positive
        positive = scalar >= -c.HYSTERESIS;
    else
        positive = scalar > c.HYSTERESIS;
    end
end

% Whether the filtered error must be sent.
function answer = fires(c, self, filtered)
    if isempty(self.sent) || c.EVERY_SAMPLE ~= 0
        answer = true;
        return
    end
    difference = self.sent - filtered;
    answer = sqrt(products(difference, difference)) >= ...
        c.RELATIVE * sqrt(products(filtered, filtered)) + c.ABSOLUTE_RAD_S;
end
