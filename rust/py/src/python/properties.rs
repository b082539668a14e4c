//! Properties of Python classes that only read, or read and write, one place.

/// Python properties and where their values are: atomic numbers or slots of the object, or fields of its state. An `object` is
/// a field with a Python object, which is dropped after the lock of the state is released. A property without a setter is
/// read-only; `as` names what converts a value that is set.
macro_rules! properties {
    (@get (atomic $place:expr)) => { $place.load(::std::sync::atomic::Ordering::Relaxed) };
    (@get (slot $place:expr)) => { Python::attach(|py| $place.get(py).map(Bound::unbind)) };
    (@get (field $place:expr)) => { $place };
    (@get (object $place:expr)) => {
        Python::attach(|py| $place.as_ref().map(|object| object.clone_ref(py)))
    };
    (@set (atomic $place:expr) $value:ident) => {
        $place.store($value, ::std::sync::atomic::Ordering::Relaxed)
    };
    (@set (slot $place:expr) $value:ident) => { $place.set($value) };
    (@set (field $place:expr) $value:ident) => { $place = $value };
    (@set (object $place:expr) $value:ident) => {
        let old = ::std::mem::replace(&mut $place, $value);
        drop(old);
    };
    ($class:ident: $(
        $(#[$doc:meta])*
        $name:ident $(, $set:ident $(as $convert:ident)?)?: $type:ty = |$this:ident $(, $py:ident)?| $place:tt;
    )+) => {
        #[pymethods]
        #[allow(non_snake_case)] // names of pymavlink
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self $(, $py: Python<'_>)?) -> $type {
                    let $this = self;
                    properties!(@get $place)
                }
                $(
                    #[setter($name)]
                    fn $set(&self, $(#[pyo3(from_py_with = $convert)])? value: $type) {
                        let $this = self;
                        properties!(@set $place value);
                    }
                )?
            )+
        }
    };
}
