//! The name of this build, by which processes know that they run the same one.

use std::hash::{DefaultHasher, Hasher};

/// Version of the program, and 64 bits that tell its file from those of other builds, where the file can be read.
pub fn build_name() -> String {
    let version = concat!("version ", env!("CARGO_PKG_VERSION"));
    let file = std::env::current_exe().and_then(std::fs::read);
    let hash = |bytes: Vec<u8>| {
        let mut hasher = DefaultHasher::new();
        hasher.write(&bytes);
        hasher.finish()
    };
    file.map_or_else(|_| version.to_owned(), |bytes| format!("{version} (build {:016x})", hash(bytes)))
}
