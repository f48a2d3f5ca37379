!> The pressure solver against its own equation, on the grids that give multigrid trouble.
program test_pressure_solver
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use free_levels, only: free_levels_t, one_level
  use halo, only: halo_t, new_halo
  use kinds, only: wp
  use outcome, only: outcome_t
  use pressure_solver, only: pressure_solver_t
  implicit none

  type(communicator_t) :: comm

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
