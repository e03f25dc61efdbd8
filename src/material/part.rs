/// A material that another one is made of: its name in the scene file, and what stands there under that name.
#[derive(Clone, Debug)]
pub struct Part<M> {
    /// The name.
    pub name: String,
    material: Box<M>,
}

impl<M> Part<M> {
    /// The material that a name stands for.
    pub fn new(name: &str, material: M) -> Self {
        Self { name: name.to_owned(), material: Box::new(material) }
    }

    /// The material.
    pub fn material(&self) -> &M {
        &self.material
    }

    /// The part after its material was converted.
    pub(super) fn map<T>(&self, convert: impl FnOnce(&M) -> T) -> Part<T> {
        Part::new(&self.name, convert(&self.material))
    }
}
