//! State problems for the nonsmooth framework.
