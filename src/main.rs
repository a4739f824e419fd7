//! The `steadfast` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    steadfast::cli::run(std::env::args_os())
}
