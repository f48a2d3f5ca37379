!> A manufactured flow of gas among particles in a periodic unit cube (Roache, J. Fluids Eng. 124 (2002) 4): void fraction,
!> velocity, pressure and drag coefficient that vary in space and time, and the source that makes them a solution of
!>
!>   d(eps)/dt + div(eps u) = 0
!>   eps rho (du/dt + u . grad u) = -eps grad p + div(eps mu grad u) + div(eps mu_t 2 S) - beta u + s.
!>
!> with S the deviator of the rate of strain and mu_t = rho l^2 |S|, |S|^2 = 2 S_ij S_ij, if there is a mixing length l.
!> Derivatives are taken by sixth-order differences over 1 mm, exact to 1e-9 of the fields: no algebra can be wrong.
module manufactured
  use constants, only: pi
  use kinds, only: wp
  implicit none
  private
  public :: flow_t, rho, mu, mean_void

  real(wp), parameter :: rho = 1.3_wp, mu = 0.03_wp, k = 2*pi, frequency = 3.0_wp, mean_void = 0.7_wp
  real(wp), parameter :: step = 1.0e-3_wp
  real(wp), parameter :: first(3) = [45.0_wp, -9.0_wp, 1.0_wp]/60     !< weights of f(+i) - f(-i)
  real(wp), parameter :: second(0:3) = [-490.0_wp, 270.0_wp, -27.0_wp, 2.0_wp]/180  !< of f(+i) + f(-i); f(0) once

  integer, parameter, public :: void = 0, pressure = 4  !< fields; 1 to 3 are the components of the velocity

  type :: flow_t
    logical :: flat = .true.      !< nothing varies along z, and nothing flows there
    real(wp) :: mixing = 0.0_wp   !< length l [m]
  contains
    procedure :: field
    procedure :: drag
    procedure :: source
    procedure :: strain
    procedure :: eddy_force
    procedure :: slope
    procedure :: viscous_force
    procedure, private :: carried
    procedure, private :: bend
  end type flow_t

contains

  !> One of the fields at (x, y, z, t). The flux eps u makes up for the growth of eps, plus eddies.
  pure function field(self, which, x) result(f)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: which
    real(wp), intent(in) :: x(4)  !< [m], [m], [m], [s]
    real(wp) :: f

    real(wp) :: along_z, wave, eps

    along_z = 1.0_wp
    if (.not. self%flat) along_z = cos(k*x(3))
    wave = 0.15_wp*sin(k*x(1) - frequency*x(4))*cos(k*x(2))*along_z
    eps = mean_void + wave
    f = 0.0_wp
    select case (which)
    case (void)
      f = eps
    case (1)
      f = (0.2_wp + frequency/k*wave + 0.5_wp*sin(k*x(2) + x(4)))/eps
    case (2)
      f = (0.4_wp*sin(k*x(1) - x(4))*along_z - 0.1_wp)/eps
    case (3)
      if (.not. self%flat) f = 0.3_wp*cos(k*x(1) + k*x(2) + x(4))/eps
    case default
      f = 0.5_wp*cos(k*x(1))*sin(k*x(2) + 2*x(4))*along_z
    end select
  end function field

  !> Drag coefficient beta [kg/(m3 s)].
  pure function drag(self, x) result(beta)
    class(flow_t), intent(in) :: self
    real(wp), intent(in) :: x(4)
    real(wp) :: beta

    beta = 5*(1 - self%field(void, x))*(1.5_wp + sin(k*x(2)))
  end function drag

  !> s [N/m3].
  pure function source(self, x) result(s)
    class(flow_t), intent(in) :: self
    real(wp), intent(in) :: x(4)
    real(wp) :: s(3)

    real(wp) :: eps
    integer :: a

    eps = self%field(void, x)
    do a = 1, 3
      s(a) = eps*rho*self%slope(a, x, 4) + eps*self%slope(pressure, x, a) + self%drag(x)*self%field(a, x) &
        - self%viscous_force(a, x) + eps*rho*self%carried(a, x)
    end do
    if (self%mixing > 0.0_wp) s = s - self%eddy_force(x)
  end function source

  !> u . grad u_a [m/s2].
  pure function carried(self, a, x)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: a
    real(wp), intent(in) :: x(4)
    real(wp) :: carried

    integer :: b

    carried = 0.0_wp
    do b = 1, 3
      carried = carried + self%field(b, x)*self%slope(a, x, b)
    end do
  end function carried

  !> Component a of div(eps mu grad u) [N/m3].
  pure function viscous_force(self, a, x) result(force)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: a
    real(wp), intent(in) :: x(4)
    real(wp) :: force

    integer :: b

    force = 0.0_wp
    do b = 1, 3
      force = force + mu*(self%slope(void, x, b)*self%slope(a, x, b) + self%field(void, x)*self%bend(a, x, b))
    end do
  end function viscous_force

  !> div(eps mu_t 2 S) [N/m3].
  pure function eddy_force(self, x) result(force)
    class(flow_t), intent(in) :: self
    real(wp), intent(in) :: x(4)
    real(wp) :: force(3)

    real(wp) :: away(4)
    integer :: b, i, way

    force = 0.0_wp
    do b = 1, 3
      if (self%flat .and. b == 3) cycle
      do way = -1, 1, 2
        do i = 1, 3
          away = 0.0_wp
          away(b) = way*i*step
          force = force + way*first(i)/step*stress_across(self, b, x + away)
        end do
      end do
    end do
  end function eddy_force

  !> The column b of eps mu_t 2 S [Pa].
  pure function stress_across(self, b, x) result(stress)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: b
    real(wp), intent(in) :: x(4)
    real(wp) :: stress(3)

    real(wp) :: s(3, 3)

    s = self%strain(x)
    stress = self%field(void, x)*rho*self%mixing**2*sqrt(2*sum(s**2))*2*s(:, b)
  end function stress_across

  !> S [1/s].
  pure function strain(self, x) result(s)
    class(flow_t), intent(in) :: self
    real(wp), intent(in) :: x(4)
    real(wp) :: s(3, 3)

    real(wp) :: trace
    integer :: a, b

    do b = 1, 3
      do a = 1, 3
        s(a, b) = self%slope(a, x, b)
      end do
    end do
    trace = s(1, 1) + s(2, 2) + s(3, 3)
    s = 0.5_wp*(s + transpose(s))
    do a = 1, 3
      s(a, a) = s(a, a) - trace/3
    end do
  end function strain

  !> First derivative of a field along b, 4 being time.
  pure function slope(self, which, x, b)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: which, b
    real(wp), intent(in) :: x(4)
    real(wp) :: slope

    real(wp) :: away(4)
    integer :: i

    slope = 0.0_wp
    do i = 1, 3
      away = 0.0_wp
      away(b) = i*step
      slope = slope + first(i)*(self%field(which, x + away) - self%field(which, x - away))/step
    end do
  end function slope

  !> Second derivative.
  pure function bend(self, which, x, b)
    class(flow_t), intent(in) :: self
    integer, intent(in) :: which, b
    real(wp), intent(in) :: x(4)
    real(wp) :: bend

    real(wp) :: away(4)
    integer :: i

    bend = second(0)*self%field(which, x)/step**2
    do i = 1, 3
      away = 0.0_wp
      away(b) = i*step
      bend = bend + second(i)*(self%field(which, x + away) + self%field(which, x - away))/step**2
    end do
  end function bend

end module manufactured
