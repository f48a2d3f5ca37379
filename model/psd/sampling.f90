!> Sizes of parcels drawn from a powder so evenly that a thousand of them carry its means.
!>
!> The parcels' own distribution, ~ d^q p_N(d) with q = 3 theta, is cut into n strata of equal share, and each
!> parcel takes a mean over one stratum,
!>
!>   d_i = ( n integral of d(u)^s du over stratum i )^(1/s),   s = 3 - 2 q
!>
!> with the quantile function d(u). All parcels of SSW (q = 0, s = 3) then hold the powder's mass and all of
!> SSP (q = 3, s = -3) its number of particles to the accuracy of the quadrature, tails included; at s = 0 it is
!> the geometric mean. Sizes of a table are not averaged: there a parcel takes the size at the middle of
!> its stratum.
module sampling
  use kinds, only: wp
  use quantiles, only: quantiles_t
  use size_distribution, only: size_distribution_t
  use weighting, only: weighting_t, sphere_volume
  implicit none
  private
  public :: draw_number, draw_mass, mean_parcel_mass

  ! Gauss-Legendre rule of five points on [0,1]; Abramowitz and Stegun, table 25.4
  real(wp), parameter :: point(5) = 0.5_wp + 0.5_wp*[-0.906179845938663993_wp, -0.538469310105683091_wp, 0.0_wp, &
    0.538469310105683091_wp, 0.906179845938663993_wp]
  real(wp), parameter :: point_weight(5) = 0.5_wp*[0.236926885056189088_wp, 0.478628670499366468_wp, &
    0.568888888888888889_wp, 0.478628670499366468_wp, 0.236926885056189088_wp]

contains

  !> Diameters of n parcels, rising [m].
  pure subroutine draw_number(distribution, weighting, n, diameter)
    type(size_distribution_t), intent(in) :: distribution
    type(weighting_t), intent(in) :: weighting
    integer, intent(in) :: n
    real(wp), allocatable, intent(out) :: diameter(:)

    type(quantiles_t) :: quantiles
    real(wp) :: d(size(point))
    integer :: i, k

    quantiles = distribution%weighted_by(3.0_wp*weighting%theta)
    allocate (diameter(n))
    do i = 1, n
      if (distribution%discrete) then
        diameter(i) = quantiles%at((i - 0.5_wp)/n)
      else
        do k = 1, size(point)
          d(k) = quantiles%at((i - 1 + point(k))/n)
        end do
        diameter(i) = power_mean(d, 3.0_wp - 6.0_wp*weighting%theta)
      end if
    end do
  end subroutine draw_number

  !> Diameters of as many parcels as together weigh `mass`, to half the mass of a mean parcel; rising [m].
  pure subroutine draw_mass(distribution, weighting, density, mass, diameter)
    type(size_distribution_t), intent(in) :: distribution
    type(weighting_t), intent(in) :: weighting
    real(wp), intent(in) :: density  !< of a particle [kg/m3]
    real(wp), intent(in) :: mass     !< of all parcels [kg]
    real(wp), allocatable, intent(out) :: diameter(:)

    real(wp) :: each, missing
    integer :: n, attempt, change

    each = mean_parcel_mass(distribution, weighting, density)
    n = nint(mass/each)
    do attempt = 1, 5
      call draw_number(distribution, weighting, n, diameter)
      missing = mass - sum(density*sphere_volume(diameter)*weighting%weight(diameter))
      change = nint(missing/each)
      if (change == 0 .or. n + change < 0) exit
      n = n + change
    end do
  end subroutine draw_mass

  !> Mean mass of a parcel [kg]: rho pi/6 W_0 d_0^q <d^3>/<d^q> with q = 3 theta.
  pure function mean_parcel_mass(distribution, weighting, density) result(mass)
    type(size_distribution_t), intent(in) :: distribution
    type(weighting_t), intent(in) :: weighting
    real(wp), intent(in) :: density  !< of a particle [kg/m3]
    real(wp) :: mass

    real(wp) :: d, q

    q = 3.0_wp*weighting%theta
    d = distribution%number_mean()
    mass = density*sphere_volume(d)*weighting%weight(d)*(distribution%moment(3.0_wp)/d**3)/(distribution%moment(q)/d**q)
  end function mean_parcel_mass

  !> (sum of weight d^s)^(1/s), the geometric mean at s = 0; lies between the smallest and the largest d [m].
  pure function power_mean(d, s) result(mean)
    real(wp), intent(in) :: d(:)  !< at the points of the rule [m]
    real(wp), intent(in) :: s
    real(wp) :: mean

    if (abs(s) < 1.0e-6_wp) then
      mean = exp(sum(point_weight*log(d)))
    else
      mean = d(3)*sum(point_weight*(d/d(3))**s)**(1.0_wp/s)
    end if
    mean = min(max(mean, d(1)), d(size(d)))
  end function power_mean

end module sampling
