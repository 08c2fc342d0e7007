//! One set of features for all builds of the repository.
//!
//! Tools of the tests switch on features of other crates, on which nearly all crates here depend. A build without tests would leave these
//! features off and so compile nearly everything again. The package for Python and the fuzz targets depend on this crate, which switches
//! them on too. It has no code.
