//! The name of this build on this processor, by which processes know that their results have the same bits.

use std::hash::{DefaultHasher, Hasher};

/// Version of the program, 64 bits that tell its file from those of other builds, where the file can be read, and the
/// vector instructions of the processor, which the linear algebra is chosen by.
pub fn build_name() -> String {
    format!("{} with {}", program(), vector_instructions())
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn vector_instructions() -> String {
    let sets = [
        ("sse4.1", is_x86_feature_detected!("sse4.1")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512", is_x86_feature_detected!("avx512f")),
    ];
    sets.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect::<Vec<_>>().join(" ")
}

/// Other processors have no choice of them.
#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn vector_instructions() -> String {
    std::env::consts::ARCH.to_owned()
}

/// Version and file of the program.
fn program() -> String {
    let version = concat!("version ", env!("CARGO_PKG_VERSION"));
    let file = std::env::current_exe().and_then(std::fs::read);
    let hash = |bytes: Vec<u8>| {
        let mut hasher = DefaultHasher::new();
        hasher.write(&bytes);
        hasher.finish()
    };
    file.map_or_else(|_| version.to_owned(), |bytes| format!("{version} (build {:016x})", hash(bytes)))
}
