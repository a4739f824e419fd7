function @name@_test_vectors()
% Compares @compared@ with the answers in @name@_vectors.h, bit by bit.
% Prints the first difference and ends with an error where there is one.
%
% In MATLAB or Octave, in the folder of the exported files: @name@_test_vectors
%
% @about_file@

    folder = fileparts(mfilename('fullpath'));
    expected = read_vectors(fullfile(folder, '@name@_vectors.h'));
    limits = [@limits@]';
@compare_reference@    rehash();
    if exist('@name@_mex', 'file') == 3
        compare('@name@_mex', expected, limits, @name@_mex('init'), @mex_step);
    else
        fprintf('%s\n', 'SKIPPED: @name@_mex is not built; in this folder:', ...
            '  MATLAB: mex CFLAGS=''$CFLAGS -std=c99 -ffp-contract=off'' @name@_mex.c @name@.c', ...
            '  Octave: setenv(''CFLAGS'', ''-O2 -std=c99 -ffp-contract=off'')', ...
            '          mkoctfile(''--mex'', ''@name@_mex.c'', ''@name@.c'')');
    end
end

% The MEX function with the state first, as the reference has it.
function [state, command, sent, status] = mex_step(state, time_s, varargin)
    [command, sent, status, state] = @name@_mex('step', state, time_s, varargin{:});
end

% One pass over all samples.
function compare(what, expected, limits, state, step)
    count = size(expected.given, 1);
    for sample = 1:count
        given = num2cell(expected.given(sample, :));
        [state, command, sent, status] = step(state, given{1}, @m_from_row@);
        wanted = expected.commands(sample, :)';
        % Without functions of the library the tolerance is 0, and only the same bits will do.
        same = typecast(command, 'uint64') == typecast(wanted, 'uint64') | ...
            abs(command - wanted) < expected.tolerance * limits;
        if ~all(same) || sent ~= expected.flags(sample, 1) || status ~= expected.flags(sample, 2)
            fprintf('%s, sample %d (from 0):\n', what, sample - 1);
            fprintf('  command %.17g, expected %.17g\n', [command, wanted]');
            fprintf('  sent %d, expected %d; status %d, expected %d\n', sent, expected.flags(sample, 1), status, ...
                expected.flags(sample, 2));
            fprintf('%s\n', '  A MEX file that differs in the last digits only was built without -ffp-contract=off.');
            error('@name@:vectors', '%s FAILED', what);
        end
    end
    fprintf('PASSED: %s, %d samples\n', what, count);
end

% The tables of the header of vectors: numbers by their bits.
function expected = read_vectors(name)
    text = fileread(name);
    expected.given = bits(rows_of(text, '@name@_given['));
    expected.commands = bits(rows_of(text, '@name@_commands['));
    flags = cellfun(@str2double, regexp(rows_of(text, '@name@_flags['), '\d+(?=U)', 'match'));
    expected.flags = reshape(flags, 3, [])';
    tolerance = regexp(text, '@NAME@_TOLERANCE ([-+.0-9e]+)', 'tokens', 'once');
    expected.tolerance = str2double(tolerance{1});
end

% The rows of a table.
function rows = rows_of(text, name)
    first = strfind(text, name);
    rows = text(first(1):end);
    rows = rows(find(rows == '=', 1):end);
    last = strfind(rows, '};');
    rows = rows(1:last(1));
end

% A matrix from the bits of its rows.
function values = bits(rows)
    words = regexp(rows, '(?<=0x)[0-9a-f]{16}', 'match');
    height = sum(rows == '}') - 1;
    values = reshape(hex2num(char(words)), [], height)';
end
