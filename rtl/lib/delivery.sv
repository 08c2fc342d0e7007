// Delivers tokens of a unit in order, each so many cycles after the start of its step, and not before its memory answers (law 3).
//
// `counts` marks a step whose answers are counted: it awaits answers, and has a token or blocks its unit. `answered` is the number of such
// steps whose answers are complete. `asked` is the number of steps before this one. A token that awaits answers is delivered
// `after` cycles after the last of them at the earliest.
`default_nettype none
module delivery #(parameter W = 8, DEPTH = 64, L = 16) (
    input  wire         clk, rst,
    input  wire         put,
    input  wire [W-1:0] data,
    input  wire [L-1:0] latency,
    input  wire         counts,
    input  wire [L-1:0] after,
    input  wire [31:0]  answered,
    output reg  [31:0]  asked,
    output wire         push,
    output wire [W-1:0] out
);
    localparam A = DEPTH > 1 ? $clog2(DEPTH) : 1;
    reg [W-1:0] tokens [0:DEPTH-1];
    reg [31:0] due [0:DEPTH-1];
    reg [31:0] number [0:DEPTH-1];
    reg [L-1:0] extra [0:DEPTH-1];
    reg [DEPTH-1:0] waits;
    reg [31:0] now;
    reg [A-1:0] head, tail;
    reg [A:0] held;
    wire [31:0] base = now + {{(32-L){1'b0}}, latency}, with_data = now + {{(32-L){1'b0}}, after};
    wire is_answered = !counts || answered > asked;
    wire is_due = now >= due[head] && (!waits[head] || (answered > number[head] && extra[head] == 0));
    wire bypass = held == 0 && put && is_answered && latency == 0 && (!counts || after == 0);
    wire pops = held != 0 && is_due;
    assign push = pops || bypass;
    assign out = held == 0 ? data : tokens[head];
    integer i;
    always @(posedge clk)
        if (rst) begin
            now <= 0;
            asked <= 0;
            head <= 0;
            tail <= 0;
            held <= 0;
            waits <= 0;
        end else begin
            now <= now + 1;
            if (counts) asked <= asked + 1;
            if (waits != 0) for (i = 0; i < DEPTH; i = i + 1)
                if (waits[i] && answered > number[i]) begin
                    waits[i] <= 1'b0;
                    if (now + {{(32-L){1'b0}}, extra[i]} > due[i]) due[i] <= now + {{(32-L){1'b0}}, extra[i]};
                end
            if (put && !bypass) begin
                tokens[tail] <= data;
                due[tail] <= counts && is_answered && with_data > base ? with_data : base;
                number[tail] <= asked;
                extra[tail] <= after;
                waits[tail] <= !is_answered;
                tail <= tail == DEPTH[A-1:0] - 1'b1 ? {A{1'b0}} : tail + 1'b1;
            end
            if (pops) head <= head == DEPTH[A-1:0] - 1'b1 ? {A{1'b0}} : head + 1'b1;
            held <= held + {{A{1'b0}}, put && !bypass} - {{A{1'b0}}, pops};
        end
endmodule
`default_nettype wire
