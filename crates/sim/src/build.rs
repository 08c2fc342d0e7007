//! Identity of this build.

/// Identity of this build: the version, and a hash over the sources of the simulator. Equal sources have equal identities.
pub const BUILD: &str = env!("BASRELIEF_BUILD");

/// Returns a warning if another build of the simulator executed the steps of a recording.
pub(crate) fn build_warning(build: &str) -> Option<String> {
    let differs = build != BUILD;
    differs.then(|| format!("recording: build {build} of basrelief executed the steps, and build {BUILD} computed their timing"))
}
