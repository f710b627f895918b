//! A window or, without a display, a picture, times or a digest of outcomes.

#[cfg(not(target_arch = "wasm32"))]
mod command;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    match command::run(std::env::args().skip(1).collect()) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(trouble) => {
            eprintln!("lin-canny-viewer: {trouble}");
            std::process::ExitCode::FAILURE
        }
    }
}

/// The page uses the library, not this program.
#[cfg(target_arch = "wasm32")]
fn main() {}
