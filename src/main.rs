//! The `feeler` program: arguments in, exit code out.

fn main() -> std::process::ExitCode {
    feeler::cli::main()
}
