% Refuses a time that is not finite (3) or not later than that of the last sample used (4).
function status = check_time(self, time_s)
    status = 0;
    if ~isfinite(time_s)
        status = 3;
    elseif ~isempty(self.time_s) && time_s <= self.time_s
        status = 4;
    end
end

% The sum of products, in the order of the index.
function total = products(left, right)
    total = left(1) * right(1);
    for index = 2:numel(left)
        total = total + left(index) * right(index);
    end
end

function value = larger(left, right)
    value = right;
    if left > right
        value = left;
    end
end

function value = smaller(left, right)
    value = right;
    if left < right
        value = left;
    end
end
