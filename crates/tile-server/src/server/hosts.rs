//! The header Host. A web page of another site can send requests to a local server under a name that it controls (DNS rebinding), but
//! then the header holds that name.

use std::net::{IpAddr, SocketAddr};

/// Hosts that a server answers to.
#[derive(Clone, Debug)]
pub(crate) struct AllowedHosts {
    address: IpAddr,
    /// Further names, in lower case.
    names: Vec<String>,
}

impl AllowedHosts {
    /// Allows the address that the server listens on and these names.
    pub(crate) fn new(listening: SocketAddr, names: &[String]) -> Self {
        Self { address: listening.ip(), names: names.iter().map(|name| name.to_ascii_lowercase()).collect() }
    }

    /// Returns true if a request with this header is answered. A loopback server allows loopback addresses and `localhost`, any other
    /// server allows every numeric address, because a page of another site cannot have one as its name.
    pub(crate) fn allow(&self, header: &str) -> bool {
        let host = host_of(header).to_ascii_lowercase();
        let number = host.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
        let is_own = match number {
            Ok(number) => !self.address.is_loopback() || number.is_loopback(),
            Err(_) => host == "localhost" && (self.address.is_loopback() || self.address.is_unspecified()),
        };
        is_own || self.names.contains(&host)
    }
}

/// Returns a host without its port.
fn host_of(header: &str) -> &str {
    match header.rsplit_once(':') {
        Some((host, port)) if !port.ends_with(']') && !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => host,
        _ => header,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_names_are_refused() {
        let names = ["Render.example".to_owned()];
        let loopback = AllowedHosts::new(([127, 0, 0, 1], 8080).into(), &names);
        let public = AllowedHosts::new(([0, 0, 0, 0], 8080).into(), &[]);
        for (host, on_loopback, on_public) in [
            ("127.0.0.1:8080", true, true),
            ("127.0.0.1", true, true),
            ("[::1]:8080", true, true),
            ("[::1]", true, true),
            ("LocalHost:9", true, true),
            ("render.example:8080", true, false),
            ("192.168.0.7:8080", false, true),
            ("evil.example", false, false),
            ("127.0.0.1.evil.example", false, false),
            ("localhost.evil.example:8080", false, false),
            ("", false, false),
        ] {
            assert_eq!((loopback.allow(host), public.allow(host)), (on_loopback, on_public), "{host}");
        }
    }
}
