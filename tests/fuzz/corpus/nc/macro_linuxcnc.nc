o100 sub
  G1 X#1 Y[#2 * 2] F100
o100 endsub
G0 X0 Y0 Z0
#<n> = 3
o101 while [#<n> gt 0]
  o100 call [#<n>] [sin[30]]
  #<n> = [#<n> - 1]
o101 endwhile
o102 repeat [2]
G91 G1 X1
o102 endrepeat
o103 if [#<n> eq 0]
G90 G1 X5
o103 else
G1 X7
o103 endif
M2
