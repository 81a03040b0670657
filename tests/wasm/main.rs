//! The golden scene of the tests as a program of its own, for WebAssembly: see `run.sh`.

#[path = "../common/golden.rs"]
mod golden;

use std::process::ExitCode;

fn main() -> ExitCode {
    let same = golden::run(golden::mixed_scene()) == golden::GOLDEN;
    if same {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
