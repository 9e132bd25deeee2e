//! Published nonsmooth test problems.
