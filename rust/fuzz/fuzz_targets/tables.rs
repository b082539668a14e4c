#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| mavwire_fuzz::tables(data));
