//! Constructors of classes that Python derives from: a class of a program takes arguments of its own.

/// `__new__` of a class, called with the class to make an instance of. It leaves the arguments to `__init__`.
macro_rules! new {
    ($class:ident: |$cls:ident| -> $result:ty $body:block) => {
        #[pymethods]
        impl $class {
            #[new]
            #[classmethod]
            #[pyo3(signature = (*_args, **_kwargs))]
            fn new_of(
                $cls: &Bound<'_, ::pyo3::types::PyType>,
                _args: &Bound<'_, ::pyo3::types::PyTuple>,
                _kwargs: Option<&Bound<'_, ::pyo3::types::PyDict>>,
            ) -> $result $body
        }
    };
}
