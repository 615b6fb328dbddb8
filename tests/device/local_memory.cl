// Local memory that reaches a function which is not inlined: each group sums its own number sixteen times,
// ten thousand times. PoCL 3.1 with two threads or more gets some sums wrong; local_memory.py runs this.
__attribute__((noinline)) static int sum_of(int value, local int* shared) {
  shared[get_local_id(0)] = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  int sum = 0;
  for (int n = 0; n < 16; ++n) sum += shared[n];
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

kernel void sums(global int* result) {
  local int shared[16];
  int sum = 0;
  for (int round = 0; round < 10000; ++round) sum += sum_of((int)get_group_id(0), shared);
  if (get_local_id(0) == 0) result[get_group_id(0)] = sum;
}
