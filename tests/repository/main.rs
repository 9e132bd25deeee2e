//! What the repository promises about itself: packages, licences, sizes of files, references, numbers
//! that pages share.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod architecture;
mod circles;
mod facts;
mod methods;
mod pictures;
mod published;
mod references;
