/// Who looks on while an image is made.
pub(super) struct Watch<'a> {
    /// Is told how many camera samples, or photons, were done since it was last told, from any thread.
    pub(super) progress: &'a (dyn Fn(u64) + Sync),
    /// Says when to stop for a while; is asked again and again, from any thread.
    pub(super) is_due: &'a (dyn Fn() -> bool + Sync),
}
