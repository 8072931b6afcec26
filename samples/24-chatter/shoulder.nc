(shoulder 4 mm wide, three passes)
G21 G90 G54
T1 M6
S9000 M3
G0 X-8. Y-2. Z5.
G0 X-8. Y-2.
G0 Z-2.
G1 X32. F2160
G0 Z5.
G0 X-8. Y-2.
G0 Z-3.
G1 X32. F2160
G0 Z5.
G0 X-8. Y-2.
G0 Z-4.
G1 X32. F2160
G0 Z5.
M30
