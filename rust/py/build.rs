//! Passes on what PyO3 found out about the interpreter (`Py_GIL_DISABLED`).

fn main() {
    pyo3_build_config::use_pyo3_cfgs();
}
