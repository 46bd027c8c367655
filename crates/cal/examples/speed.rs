//! Times typical patterns: `cargo run --release -p ambit-cal --example speed`.

use std::hint::black_box;
use std::time::Instant;

use ambit_cal::{CHANNELS, Context, Inputs, Library, Scratch};

const PATTERNS: [(&str, &str); 7] = [
    ("number", "v=3;"),
    ("20 sums and products", "v=((Px*3+Py*2-1)*(Pz+4)+Dx*Dy*.5)*(Px-Py)+(Dz*Dz+1)*(Nx+2*Ny)-Px*Py*Pz+Rdot*T;"),
    (
        "20 operations, one division, one if, one sqrt",
        "v=if(Px-Py,(Px*3+Py*2-1)*(Pz+4),Dx*Dy*.5)/(Nz+2)+sqrt(Px*Px+Py*Py)*3-Rdot*.2+T*S;",
    ),
    ("variables used twice", "a=Px*2+1;b=a*a+Py;v=a*b+b*Pz+a;"),
    ("functions in line", "m(a,b)=if(a-b,b,a);n(x)=bound(0,x,1);v=m(n(Px),n(Py))+frac(Px*3)+mod(Py,.5);"),
    ("recursion, ten deep", "f(n)=if(n-.5,Px+f(n-1),0);v=f(10);"),
    ("noise3", "v=1+.1*noise3(Px*10,Py*10,Pz*10);"),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scratch = Scratch::new();
    let mut channels: [f64; CHANNELS] = std::array::from_fn(|k| 0.3 + 0.01 * k as f64);
    for (title, text) in PATTERNS {
        let mut library = Library::renderer()?;
        library.load_file("p.cal", "p.cal", text.as_bytes())?;
        let program = library.compile("v", &Context::of_file("p.cal"), "")?;
        let mut best = f64::INFINITY;
        for _ in 0..400 {
            // Short enough to fit between the interruptions of a busy machine.
            const ROUNDS: u32 = 1000;
            let start = Instant::now();
            for round in 0..ROUNDS {
                channels[6] = f64::from(round) * 1e-5;
                let mut pass = scratch.pass(Inputs { channels: &channels, reals: &[] });
                black_box(pass.eval(black_box(&program))?);
            }
            best = best.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(ROUNDS));
        }
        println!("{best:8.1} ns  {title}");
    }
    Ok(())
}
