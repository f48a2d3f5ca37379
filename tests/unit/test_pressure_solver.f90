!> The pressure solver against its own equation, on the grids that give multigrid trouble.
program test_pressure_solver
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_all, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use free_levels, only: free_levels_t, one_level
  use halo, only: halo_t, new_halo
  use kinds, only: wp
  use outcome, only: outcome_t
  use pressure_solver, only: pressure_solver_t, pace_size
  implicit none

  type :: problem_t
    type(boxes_t) :: boxes
    type(halo_t) :: halo
    real(wp), allocatable :: c(:,:,:,:), b(:,:,:)
  end type problem_t

  type(communicator_t) :: comm
  type(free_levels_t) :: no_levels

  call start_ranks(comm)
  call solve_one('even, outflow above', [16, 120, 4], [.false., .false., .false.], 2, 25)
  call solve_one('one cell thick', [16, 60, 1], [.false., .false., .false.], 2, 25)
  call solve_one('one cell thick, periodic', [16, 60, 1], [.true., .false., .true.], 2, 25)
  call solve_one('odd', [9, 25, 7], [.false., .false., .false.], 2, 25)
  call solve_one('periodic and odd', [9, 25, 5], [.true., .false., .true.], 2, 80)
  call solve_one('many and odd', [63, 32, 63], [.true., .false., .true.], 2, 80)
  call solve_one('closed', [16, 24, 8], [.false., .false., .false.], 0, 25)
  call solve_one('closed, all periodic', [16, 24, 8], [.true., .true., .true.], 0, 25)
  call solve_one('closed, periodic, odd', [9, 15, 1], [.true., .true., .true.], 0, 50)
  call solve_one('two cells', [2, 8, 2], [.true., .false., .false.], 2, 25)
  call solve_many()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Random face coefficients over a decade: the residual must have fallen as asked.
  subroutine solve_one(name, cells, periodic, outflow, most)
    character(len=*), intent(in) :: name
    integer, intent(in) :: cells(3), outflow  !< direction whose upper end has a given pressure, or 0
    logical, intent(in) :: periodic(3)
    integer, intent(in) :: most  !< iterations

    real(wp), parameter :: reduction = 1.0e-9_wp
    type(boxes_t) :: boxes
    type(halo_t) :: halo
    type(outcome_t) :: outcome
    type(pressure_solver_t) :: solver
    type(free_levels_t) :: levels
    real(wp), allocatable :: c(:,:,:,:), b(:,:,:), p(:,:,:)
    real(wp) :: left, given
    integer :: iterations
    character(len=12) :: count

    call new_boxes(comm, cells, periodic, boxes, outcome)
    halo = new_halo(boxes)
    call make_problem(boxes, halo, outflow, c, b, p)
    if (outflow == 0) levels = one_level(boxes)
    call solver%create(boxes, levels)
    call solver%set_matrix(c)
    given = sqrt(comm%sum(sum(b**2)))
    call solver%solve(b, reduction, p, iterations)
    call halo%exchange(p)
    left = sqrt(comm%sum(sum(residual(boxes%n, c, b, p)**2)))
    call solver%destroy()
    if (.not. comm%is_root()) return
    write (count, '(i0)') iterations
    call expect(left <= 2*reduction*given, name//': solved in '//trim(count)//' iterations')
    call expect(iterations <= most, name//': few enough iterations')
  end subroutine solve_one

  !> Matrices that drift apart by powers of their coefficients, then one that is far off: multigrid is kept, and set up anew once it
  !> is worn; a solver that takes over its state goes on bit for bit.
  subroutine solve_many()
    type(problem_t) :: problem
    type(outcome_t) :: outcome
    type(pressure_solver_t) :: kept, heir
    real(wp), allocatable :: p(:,:,:), q(:,:,:), matrix(:,:,:,:)
    real(wp) :: pace(pace_size)
    integer :: step, iterations, of_fresh, extra, at_worst
    logical :: same

    call new_boxes(comm, [16, 24, 8], [.false., .false., .false.], problem%boxes, outcome)
    problem%halo = new_halo(problem%boxes)
    call make_problem(problem%boxes, problem%halo, 2, problem%c, problem%b, p)
    allocate (q, source=p)
    associate (n => problem%boxes%n)
      allocate (matrix(n(1), n(2), n(3), 4))
    end associate
    call kept%create(problem%boxes, no_levels)
    call heir%create(problem%boxes, no_levels)
    extra = 0
    same = .true.
    do step = 0, 9
      call solve_power(problem, 1 + 0.02_wp*step, kept, p, iterations)
      call solve_afresh(problem, 1 + 0.02_wp*step, q, of_fresh)
      extra = extra + iterations - of_fresh
      same = same .and. .not. any(abs(p - q) > 0.0_wp)
    end do
    call expect_all(extra <= 10, 'multigrid of matrices that hardly change costs few iterations')
    call expect_all(.not. same, 'it was kept')
    call kept%export_state(matrix, pace)
    call heir%import_state(matrix, pace)
    call solve_power(problem, 1.2_wp, kept, p, iterations)
    call solve_power(problem, 1.2_wp, heir, q, of_fresh)
    call expect_all(iterations == of_fresh .and. .not. any(abs(p - q) > 0.0_wp), 'what takes over its state goes on bit for bit')
    call kept%remember()
    do step = 1, 3
      call solve_power(problem, 3.0_wp, kept, p, iterations)
    end do
    call kept%recall()
    call solve_power(problem, 1.22_wp, kept, p, iterations)
    call solve_power(problem, 1.22_wp, heir, q, of_fresh)
    call expect_all(iterations == of_fresh .and. .not. any(abs(p - q) > 0.0_wp), 'as does what is taken back')
    at_worst = 0
    do step = 1, 3
      call solve_power(problem, 3.0_wp, kept, p, iterations)
      call solve_afresh(problem, 3.0_wp, q, of_fresh)
      at_worst = max(at_worst, iterations - of_fresh)
    end do
    call expect_all(at_worst > 10, 'that of a matrix far off costs many')
    call expect_all(iterations == of_fresh .and. .not. any(abs(p - q) > 0.0_wp), 'once: then it is set up anew')
    call kept%destroy()
    call heir%destroy()
  end subroutine solve_many

  !> By a solver that has seen no other matrix.
  subroutine solve_afresh(problem, power, p, iterations)
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: power
    real(wp), intent(inout), contiguous :: p(-1:, -1:, -1:)
    integer, intent(out) :: iterations

    type(pressure_solver_t) :: fresh

    call fresh%create(problem%boxes, no_levels)
    call solve_power(problem, power, fresh, p, iterations)
    call fresh%destroy()
  end subroutine solve_afresh

  !> For coefficients to some power; the residual must have fallen.
  subroutine solve_power(problem, power, solver, p, iterations)
    type(problem_t), intent(inout) :: problem
    real(wp), intent(in) :: power
    type(pressure_solver_t), intent(inout) :: solver
    real(wp), intent(inout), contiguous :: p(-1:, -1:, -1:)
    integer, intent(out) :: iterations

    real(wp), parameter :: reduction = 1.0e-6_wp
    real(wp), allocatable :: c(:,:,:,:), b(:,:,:)
    real(wp) :: left

    allocate (c(-1:ubound(p, 1), -1:ubound(p, 2), -1:ubound(p, 3), 3), source=0.0_wp)
    where (problem%c > 0.0_wp) c = problem%c**power
    b = problem%b
    call solver%set_matrix(c)
    call solver%solve(b, reduction, p, iterations)
    call problem%halo%exchange(p)
    left = sqrt(comm%sum(sum(residual(problem%boxes%n, c, problem%b, p)**2)))
    call expect_all(left <= 2*reduction*sqrt(comm%sum(sum(problem%b**2))), 'solved, whatever multigrid was set up for')
  end subroutine solve_power

  !> Coefficients and right-hand side made from the cell's place in the whole grid, the same on any ranks.
  subroutine make_problem(boxes, halo, outflow, c, b, p)
    type(boxes_t), intent(in) :: boxes
    type(halo_t), intent(inout) :: halo
    integer, intent(in) :: outflow
    real(wp), allocatable, intent(out) :: c(:,:,:,:), b(:,:,:), p(:,:,:)

    integer :: a, i, j, k, n(3), cell(3), edge(3)

    n = boxes%n
    allocate (c(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), p(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=0.0_wp)
    allocate (b(n(1), n(2), n(3)))
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          cell = boxes%lo + [i, j, k] - 1
          b(i, j, k) = sin(1.0_wp + dot_product([0.7_wp, 0.3_wp, 1.1_wp], real(cell, wp)))
          do a = 1, 3
            edge = merge(cell, 0, [1, 2, 3] == a)
            if (any(edge == boxes%cells) .and. .not. boxes%periodic(a) .and. a /= outflow) cycle
            c(i, j, k, a) = 10.0_wp**(0.5_wp*sin(12.9898_wp*cell(1) + 78.233_wp*cell(2) + 37.719_wp*cell(3) + a))
          end do
        end do
      end do
    end do
    call halo%exchange_many(c)
    if (outflow == 0) b = b - comm%sum(sum(b))/product(real(boxes%cells, wp))
  end subroutine make_problem

  !> b - sum c_f (p - p_beyond)
  pure function residual(n, c, b, p) result(r)
    integer, intent(in) :: n(3)
    real(wp), intent(in) :: c(-1:, -1:, -1:, :), b(:,:,:), p(-1:, -1:, -1:)
    real(wp) :: r(n(1), n(2), n(3))

    integer :: i, j, k

    do concurrent (k=1:n(3), j=1:n(2), i=1:n(1))
      r(i, j, k) = b(i, j, k) &
        - c(i, j, k, 1)*(p(i, j, k) - p(i + 1, j, k)) - c(i - 1, j, k, 1)*(p(i, j, k) - p(i - 1, j, k)) &
        - c(i, j, k, 2)*(p(i, j, k) - p(i, j + 1, k)) - c(i, j - 1, k, 2)*(p(i, j, k) - p(i, j - 1, k)) &
        - c(i, j, k, 3)*(p(i, j, k) - p(i, j, k + 1)) - c(i, j, k - 1, 3)*(p(i, j, k) - p(i, j, k - 1))
    end do
  end function residual

end program test_pressure_solver
