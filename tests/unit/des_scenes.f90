!> Small scenes of parcels for the tests of model/des.
module des_scenes
  use chamber, only: chamber_t
  use communicator, only: communicator_t
  use contact_settings, only: contact_settings_t
  use des_settings, only: des_settings_t
  use kinds, only: wp, i8
  use outcome, only: outcome_t
  use solids, only: solids_t
  implicit none
  private
  public :: scene, put, cloud, place_of, run, random, softened

contains

  !> An empty chamber of the given extent from the origin, with gravity along z.
  function scene(comm, extent, gravity, contact, periodic, with_gas) result(solids)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: extent(3)             !< [m]
    real(wp), intent(in) :: gravity               !< upward [m/s2]
    type(contact_settings_t), intent(in) :: contact
    logical, intent(in), optional :: periodic(3), with_gas
    type(solids_t) :: solids

    type(chamber_t) :: chamber
    logical :: gas

    gas = .false.
    if (present(with_gas)) gas = with_gas

    chamber%lower = 0.0_wp
    chamber%upper = extent
    chamber%gravity = [0.0_wp, 0.0_wp, gravity]
    if (present(periodic)) chamber%periodic = periodic
    call solids%create(comm, chamber, contact, des_settings_t(), gas, 0.0_wp)
  end function scene

  !> Add parcels from the root; weight 1, density 2500 and powder 1 unless said otherwise.
  subroutine put(solids, x, v, diameter, weight, density, powder)
    type(solids_t), intent(inout) :: solids
    real(wp), intent(in) :: x(:,:), v(:,:), diameter(:)  !< (3,n) [m], (3,n) [m/s], (n) [m]
    real(wp), intent(in), optional :: weight(:), density(:)
    integer, intent(in), optional :: powder(:)

    real(wp) :: w(size(diameter)), rho(size(diameter))
    integer :: n, i, kind(size(diameter))

    w = 1.0_wp
    kind = 1
    rho = 2500.0_wp
    if (present(weight)) w = weight
    if (present(density)) rho = density
    if (present(powder)) kind = powder
    n = merge(size(diameter), 0, solids%comm%is_root())
    call solids%add(x(:, :n), v(:, :n), diameter(:n), w(:n), rho(:n), kind(:n), &
                    [(solids%added + i, i=1, n)])
  end subroutine put

  !> Numbers in (0, 1), the same on every machine.
  pure function random(i) result(x)
    integer, intent(in) :: i
    real(wp) :: x

    x = modulo(0.5_wp + i*0.6180339887498949_wp + 0.3_wp*sin(12.9898_wp*i), 1.0_wp)
  end function random

  !> n parcels of 1 mm, 20 % more or less, on a jittered lattice in a box, moving at random.
  subroutine cloud(n, lower, pitch, side, x, v, diameter)
    integer, intent(in) :: n, side(2)             !< parcels, and of these along x and y
    real(wp), intent(in) :: lower(3), pitch       !< [m]
    real(wp), allocatable, intent(out) :: x(:,:), v(:,:), diameter(:)

    integer :: i, a

    allocate (x(3, n), v(3, n), diameter(n))
    do i = 1, n
      x(:, i) = [modulo(i - 1, side(1)), modulo((i - 1)/side(1), side(2)), (i - 1)/product(side)]
      do a = 1, 3
        x(a, i) = lower(a) + pitch*(x(a, i) + 0.5_wp + 0.1_wp*random(7*i + a))
        v(a, i) = 0.6_wp*(random(11*i + 3*a) - 0.5_wp)
      end do
      diameter(i) = 1.0e-3_wp*(0.8_wp + 0.4_wp*random(5*i))
    end do
  end subroutine cloud

  !> The column of a parcel on this rank, 0 if it is elsewhere.
  pure function place_of(solids, id) result(column)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: id
    integer :: column

    do column = 1, solids%parcels%n
      if (solids%parcels%id(column) == id) return
    end do
    column = 0
  end function place_of

  !> Go on for a number of steps, and say so if it fails.
  subroutine run(solids, steps, dt)
    type(solids_t), intent(inout) :: solids
    integer, intent(in) :: steps
    real(wp), intent(in) :: dt  !< [s]

    type(outcome_t) :: outcome

    call solids%advance(steps, dt, outcome)
    if (outcome%failed()) print '(2a)', 'FAIL the run ended: ', outcome%message
  end subroutine run

  !> Stiffness of a linear spring as steps of dt make it [N/m]: see contact_linear.
  pure function softened(k, mass, restitution, dt)
    real(wp), intent(in) :: k, mass, restitution, dt  !< [N/m], effective [kg], [-], [s]
    real(wp) :: softened

    real(wp) :: zeta

    zeta = abs(log(restitution))/sqrt(acos(-1.0_wp)**2 + log(restitution)**2)
    softened = k*(1 - (1.0_wp/12.0_wp - 2*zeta/3)*k*dt**2/mass)
  end function softened

end module des_scenes
