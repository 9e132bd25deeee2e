//! Says which packages are missing on a system without MPI. Cargo runs this beside the build of the crate `mpi`, whose own message
//! names none.

use std::path::Path;
use std::process::{Command, exit};

/// What a build needs, by the names of Debian.
const PACKAGES: &str = "libopenmpi-dev openmpi-bin libclang-dev clang";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for variable in ["MPICC", "PATH", "LIBCLANG_PATH", "LLVM_CONFIG_PATH"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    let compiler = std::env::var("MPICC").unwrap_or_else(|_| "mpicc".into());
    let found = succeeds(&compiler, &["-show"])
        || ["mpich", "ompi", "ompi-c"].iter().any(|name| succeeds("pkg-config", &["--exists", name]));
    if !found {
        println!(
            "cargo::error=problems-mpi needs an MPI library, and `{compiler}` does not run; on Debian and Ubuntu: apt-get install \
             {PACKAGES} (docs/several_machines.md)"
        );
        exit(1);
    }
    if !has_libclang() {
        println!(
            "cargo::warning=libclang was not found in the usual places; if the build fails for it: apt-get install {PACKAGES}"
        );
    }
}

fn succeeds(program: &str, arguments: &[&str]) -> bool {
    Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
}

/// Whether the library that reads the headers of MPI is in one of the places where systems have it, or is named.
fn has_libclang() -> bool {
    let named = ["LIBCLANG_PATH", "LLVM_CONFIG_PATH"].iter().any(|variable| std::env::var_os(variable).is_some());
    let holds = |folder: &Path| {
        std::fs::read_dir(folder).is_ok_and(|entries| {
            entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libclang"))
        })
    };
    let plain = ["/usr/lib", "/usr/lib64", "/usr/local/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu"];
    let versions = std::fs::read_dir("/usr/lib").into_iter().flatten().flatten();
    let versioned = versions.map(|entry| entry.path()).filter(|path| path.to_string_lossy().contains("llvm"));
    named
        || succeeds("llvm-config", &["--version"])
        || plain.iter().any(|folder| holds(Path::new(folder)))
        || versioned.into_iter().any(|folder| holds(&folder.join("lib")))
}
