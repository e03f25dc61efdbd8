/// A material that another one is made of: its name in the scene file, and the material that has this name.
#[derive(Clone, Debug)]
pub struct Part<M> {
    /// The name.
    pub name: String,
    material: Box<M>,
}

impl<M> Part<M> {
    /// Pairs a name with its material.
    pub fn new(name: &str, material: M) -> Self {
        Self { name: name.to_owned(), material: Box::new(material) }
    }

    /// The material.
    pub fn material(&self) -> &M {
        &self.material
    }

    /// Returns the part with its material converted.
    pub(super) fn map<T>(&self, convert: impl FnOnce(&M) -> T) -> Part<T> {
        Part::new(&self.name, convert(&self.material))
    }
}
