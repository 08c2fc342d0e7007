// A bounded FIFO between two units, as laws 1 and 2 of the kernel state it.
//
// A producer reserves a slot at the start of its step and fills it at delivery. A token delivered in cycle d is visible from
// d + LATENCY. A slot is free again in the cycle after the pop.
`default_nettype none
module fifo #(parameter W = 8, DEPTH = 16, LATENCY = 1) (
    input  wire         clk, rst,
    output wire         room,
    input  wire         reserve,
    input  wire         push,
    input  wire [W-1:0] push_data,
    output wire         valid,
    output wire [W-1:0] data,
    input  wire         pop
);
    localparam A = DEPTH > 1 ? $clog2(DEPTH) : 1;
    reg [W-1:0] slots [0:DEPTH-1];
    reg [A-1:0] head, tail;
    reg [A:0] used, filled;
    // Wires between the two ends take LATENCY - 1 further cycles.
    wire arrives;
    wire [W-1:0] arriving;
    generate
        if (LATENCY == 1) begin : direct
            assign arrives = push;
            assign arriving = push_data;
        end else begin : delayed
            reg [LATENCY-2:0] moving;
            reg [W*(LATENCY-1)-1:0] line;
            always @(posedge clk) begin
                moving <= rst ? {(LATENCY-1){1'b0}} : {moving, push};
                line <= {line, push_data};
            end
            assign arrives = moving[LATENCY-2];
            assign arriving = line[W*(LATENCY-2) +: W];
        end
    endgenerate
    assign room = used != DEPTH[A:0];
    assign valid = filled != 0;
    assign data = slots[head];
    always @(posedge clk)
        if (rst) begin
            head <= 0;
            tail <= 0;
            used <= 0;
            filled <= 0;
        end else begin
            if (arrives) begin
                slots[tail] <= arriving;
                tail <= tail == DEPTH[A-1:0] - 1'b1 ? {A{1'b0}} : tail + 1'b1;
            end
            if (pop) head <= head == DEPTH[A-1:0] - 1'b1 ? {A{1'b0}} : head + 1'b1;
            used <= used + {{A{1'b0}}, reserve} - {{A{1'b0}}, pop};
            filled <= filled + {{A{1'b0}}, arrives} - {{A{1'b0}}, pop};
        end
endmodule
`default_nettype wire
