!> Taylor and Green's vortices in a periodic square: edge L = 1 m, k = 2 pi/L, density 1 kg/m3,
!>   u = U sin(kx) cos(ky) a(t),  v = -U cos(kx) sin(ky) a(t),  a = exp(-2 nu k^2 t),
!> Taylor and Green, Proc. R. Soc. A 158 (1937) 499. Convection is balanced by pressure, so that implicit Euler steps leave the
!> shape as it is, and have a = (1 + 2 nu k^2 dt)^-n after n of them: errors of space and of time are seen apart.
module vortex_flow
  use communicator, only: communicator_t
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, make_gas, steps
  use grid_axis, only: axis_t, graded_axis, uniform_axis
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none
  private
  public :: decay

  real(wp), parameter :: k = 2*pi, speed = 1.0_wp, viscosity = 0.01_wp

contains

  !> After `count` steps to `end_time` on n by n cells.
  subroutine decay(comm, n, limiter, end_time, count, shape_error, amplitude, iterations, wave)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n, count
    character(len=*), intent(in) :: limiter
    real(wp), intent(in) :: end_time           !< [s]
    real(wp), intent(out) :: shape_error       !< root mean square from the vortices that Euler's steps have, over U
    real(wp), intent(out) :: amplitude(2)      !< a, of the flow computed and of the exact one
    integer, intent(out) :: iterations         !< SIMPLE iterations of the last step; 0 if a step did not converge
    real(wp), intent(in), optional :: wave     !< cells of both directions as wide as 1 + wave cos(k s) at s n

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp), allocatable :: start(:,:,:)
    real(wp) :: dt, shrunk, sums(3)

    scene%cells = [n, n, 1]
    scene%periodic = .true.
    scene%settings%density = 1.0_wp
    scene%settings%viscosity = viscosity
    scene%numerics%limiter = limiter
    scene%numerics%tolerance = 1.0e-9_wp
    scene%numerics%velocity_tolerance = 1.0e-9_wp
    scene%numerics%maximum_iterations = 100
    allocate (scene%records(0))
    if (present(wave)) scene%axis = [wavy_axis(n, wave), wavy_axis(n, wave), uniform_axis(0.0_wp, 1.0_wp, 1, .true.)]
    call make_gas(comm, scene, gas, outcome)
    call set_vortices(gas, start)
    dt = end_time/count
    shrunk = (1 + 2*viscosity*k**2*dt)**(-count)
    iterations = 0
    if (steps(gas, count, dt)) iterations = gas%report%iterations
    associate (m => gas%boxes%n, u => gas%velocity)
      sums = [sum((u(1:m(1), 1:m(2), 1, 1:2) - shrunk*start)**2), sum(u(1:m(1), 1:m(2), 1, 1:2)*start), sum(start**2)]
    end associate
    sums = comm%sum(sums)
    shape_error = sqrt(sums(1)/n**2)/speed
    amplitude = [sums(2)/sums(3), exp(-2*viscosity*k**2*end_time)]
    call gas%destroy()
  end subroutine decay

  !> Faces at x = s + wave sin(k s)/k, s = i/n.
  pure function wavy_axis(n, wave) result(axis)
    integer, intent(in) :: n
    real(wp), intent(in) :: wave
    type(axis_t) :: axis

    integer :: i

    axis = graded_axis([((real(i, wp)/n + wave*sin(k*i/n)/k), i=0, n - 1), 1.0_wp], .true.)
  end function wavy_axis

  !> Initial velocities, and the same without halos.
  subroutine set_vortices(gas, start)
    type(gas_t), intent(inout) :: gas
    real(wp), allocatable, intent(out) :: start(:,:,:)  !< (n1,n2,2) [m/s]

    integer :: i, j
    real(wp) :: face(3), centre(3)

    associate (m => gas%boxes%n)
      allocate (start(m(1), m(2), 2))
      do j = 1, m(2)
        do i = 1, m(1)
          face = gas%mesh%in_metres(real(gas%boxes%lo + [i, j, 1] - 1, wp))  ! upper corner of the cell
          centre = gas%mesh%in_metres(gas%boxes%lo + [i, j, 1] - 1.5_wp)
          start(i, j, 1) = speed*sin(k*face(1))*cos(k*centre(2))
          start(i, j, 2) = -speed*cos(k*centre(1))*sin(k*face(2))
        end do
      end do
      gas%velocity(1:m(1), 1:m(2), 1, 1:2) = start
    end associate
  end subroutine set_vortices

end module vortex_flow
