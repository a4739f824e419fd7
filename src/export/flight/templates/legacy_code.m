% Makes a Simulink block of the controller '@name@' with the Legacy Code Tool: @name@_legacy_code
%
% Needs MATLAB with Simulink and a C compiler (mex -setup C). Run it in the folder of the exported files.
%
% Inputs of the block: the time (s), from a Digital Clock with the same sample time; @arguments@.
% Outputs: the command, whether a message is due, the status (see @name@.h).
%
% The block is discrete: one step at each of its samples. The controller lives in the block's work vector, so several
% blocks may run side by side. The proof holds for sampling intervals up to @interval_s@ s. A block that is disabled and
% enabled again begins anew only where its subsystem resets its states. Repetitions of messages are left to the model.
%
% @about_file@

def = legacy_code('initialize');
def.SFunctionName = '@name@_sfun';
def.InitializeConditionsFcnSpec = 'void @name@_block_init(double work1[@words@])';
def.OutputFcnSpec = ['void @name@_block_step(double work1[@words@], double u1, @legacy_inputs@, ' ...
    'double y1[@inputs@], uint8 y2[1], uint8 y3[1])'];
def.HeaderFiles = {'@name@_simulink.h'};
def.SourceFiles = {'@name@_simulink.c', '@name@.c'};
def.SampleTime = @interval_s@;

legacy_code('sfcn_cmex_generate', def);
if ispc
    legacy_code('compile', def);
else
    % The same bits as the reference: no product and sum in one operation.
    legacy_code('compile', def, {'CFLAGS=$CFLAGS -std=c99 -ffp-contract=off'});
end
legacy_code('sfcn_tlc_generate', def);
if usejava('desktop')
    legacy_code('slblock_generate', def);
end
