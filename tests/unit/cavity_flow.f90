!> Flow in a square cavity whose lid moves: edge 1 m, lid 1 m/s, density 1 kg/m3.
module cavity_flow
  use communicator, only: communicator_t
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none
  private
  public :: cavity_t, steady_cavity

  integer, parameter :: fine = 2000  !< places at which extremes are looked for

  !> Velocities on the two lines through the middle, walls included: u(y) at x = 1/2, v(x) at y = 1/2.
  type :: cavity_t
    real(wp), allocatable :: place(:), u(:), v(:)  !< (n+2) [m], [m/s]
    integer :: steps = 0, iterations = 0, most = 0
    logical :: steady = .false.
  contains
    procedure :: at
    procedure :: u_min, v_max, v_min
  end type cavity_t

contains

  !> From rest in steps of dt until nothing changes by more than `still` in one.
  subroutine steady_cavity(comm, n, reynolds, limiter, dt, still, cavity)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n                 !< cells along each edge; even
    real(wp), intent(in) :: reynolds, dt     !< [-], [s]
    character(len=*), intent(in) :: limiter
    real(wp), intent(in) :: still            !< [m/s]
    type(cavity_t), intent(out) :: cavity

    integer, parameter :: most_steps = 2000
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp), allocatable :: before(:,:,:,:)
    logical :: converged

    scene%cells = [n, n, 1]
    scene%periodic = [.false., .false., .true.]
    scene%settings%density = 1.0_wp
    scene%settings%viscosity = 1/reynolds
    scene%numerics%limiter = limiter
    scene%numerics%tolerance = 1.0e-6_wp
    scene%numerics%velocity_tolerance = 1.0e-6_wp
    scene%numerics%maximum_iterations = 200
    allocate (scene%records(1))
    scene%records(1) = record('lid', 'no_slip', [0.0_wp, 1.0_wp, 0.0_wp], [1.0_wp, 1.0_wp, 1.0_wp])
    scene%records(1)%wall_velocity(1) = 1.0_wp
    call make_gas(comm, scene, gas, outcome)
    do
      before = gas%velocity
      call gas%advance(dt, converged)
      call gas%accept()
      cavity%steps = cavity%steps + 1
      cavity%iterations = cavity%iterations + gas%report%iterations
      cavity%most = max(cavity%most, gas%report%iterations)
      cavity%steady = converged .and. maxval(abs(gas%velocity - before)) <= still
      if (cavity%steady .or. cavity%steps == most_steps .or. .not. converged) exit
    end do
    call read_lines(gas, n, cavity)
    call gas%destroy()
  end subroutine steady_cavity

  !> A velocity of a line at a place: the cubic through the four values around it.
  pure function at(self, values, place) result(value)
    class(cavity_t), intent(in) :: self
    real(wp), intent(in) :: values(:)  !< u or v [m/s]
    real(wp), intent(in) :: place       !< [m]
    real(wp) :: value

    real(wp) :: weight
    integer :: i, j, first

    first = min(max(count(self%place <= place) - 1, 1), size(values) - 3)
    value = 0.0_wp
    do i = first, first + 3
      weight = 1.0_wp
      do j = first, first + 3
        if (j /= i) weight = weight*(place - self%place(j))/(self%place(i) - self%place(j))
      end do
      value = value + weight*values(i)
    end do
  end function at

  !> Lowest u of the lower part of the line [m/s].
  pure function u_min(self)
    class(cavity_t), intent(in) :: self
    real(wp) :: u_min

    integer :: i

    u_min = minval([(self%at(self%u, 0.6_wp*i/fine), i=0, fine)])
  end function u_min

  !> Highest v [m/s].
  pure function v_max(self)
    class(cavity_t), intent(in) :: self
    real(wp) :: v_max

    integer :: i

    v_max = maxval([(self%at(self%v, real(i, wp)/fine), i=0, fine)])
  end function v_max

  !> Lowest v [m/s].
  pure function v_min(self)
    class(cavity_t), intent(in) :: self
    real(wp) :: v_min

    integer :: i

    v_min = minval([(self%at(self%v, real(i, wp)/fine), i=0, fine)])
  end function v_min

  !> The middle lies on faces; along a line velocities stand in the middle of cells.
  subroutine read_lines(gas, n, cavity)
    type(gas_t), intent(in) :: gas
    integer, intent(in) :: n
    type(cavity_t), intent(inout) :: cavity

    integer :: i

    cavity%place = [0.0_wp, ((i - 0.5_wp)/n, i=1, n), 1.0_wp]
    cavity%u = [0.0_wp, gas%velocity(n/2, 1:n, 1, 1), 1.0_wp]
    cavity%v = [0.0_wp, gas%velocity(1:n, n/2, 1, 2), 0.0_wp]
  end subroutine read_lines

end module cavity_flow
