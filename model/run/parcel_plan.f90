!> What a case will make of its powders, known before a single parcel exists.
module parcel_plan
  use case, only: case_t
  use constants, only: is_set, pi
  use contact_laws, only: contact_laws_t, new_contact_laws
  use kinds, only: wp
  use outcome, only: outcome_t
  use quantiles, only: quantiles_t
  use size_distribution, only: size_distribution_t, new_size_distribution
  use weighting, only: weighting_t, new_weighting, sphere_volume
  implicit none
  private
  public :: parcel_plan_t, new_parcel_plan, shortest_contact

  !> The parcels of one fill. A fill from a file has none of this.
  type :: parcel_plan_t
    logical :: known = .false.
    real(wp) :: parcels = 0            !< how many, to about one
    real(wp) :: volume = 0             !< of all its particles [m3]
    real(wp) :: means(3) = 0           !< number, mass and Sauter mean diameter of the powder [m]
    real(wp) :: particle(2) = 0        !< smallest and largest particle [m]
    real(wp) :: diameter(2) = 0        !< smallest and largest parcel [m]
    real(wp) :: weight(2) = 0          !< least and most particles in a parcel
    real(wp) :: mean_weight = 0        !< all particles over all parcels
    real(wp) :: lightest = 0           !< mass of the smallest parcel [kg]
    integer :: material = 0            !< of the powder: see contact_pairs
  end type parcel_plan_t

contains

  !> Fails where the powder of the fill, or the weighting, is not one.
  subroutine new_parcel_plan(case, fill, plan, outcome)
    type(case_t), intent(in) :: case
    integer, intent(in) :: fill   !< its place in case%fills
    type(parcel_plan_t), intent(out) :: plan
    type(outcome_t), intent(inout) :: outcome

    type(size_distribution_t) :: sizes
    type(weighting_t) :: weighting
    real(wp) :: parcel_volume

    associate (settings => case%fills(fill))
      if (settings%powder == 0 .or. .not. (is_set(settings%mass) .or. settings%number > 0)) return
      if (.not. is_set(case%powders(settings%powder)%density)) return
      call new_size_distribution(case%powders(settings%powder), sizes, outcome)
      call new_weighting(case%parcels, weighting, outcome)
      if (outcome%failed()) return
      ! Parcels of size d are drawn from d^(3 theta) p_N(d) and hold W(d) particles each.
      plan%mean_weight = weighting%weight_0*weighting%diameter_0**(3*weighting%theta)/sizes%moment(3*weighting%theta)
      parcel_volume = plan%mean_weight*sizes%moment(3.0_wp)*pi/6
      plan%means = [sizes%number_mean(), sizes%mass_mean(), sizes%sauter_mean()]
      plan%parcels = settings%number
      if (is_set(settings%mass)) plan%parcels = settings%mass/(case%powders(settings%powder)%density*parcel_volume)
      plan%volume = plan%parcels*parcel_volume
      call find_extremes(sizes%weighted_by(3*weighting%theta), weighting, plan)
      plan%lightest = case%powders(settings%powder)%density*sphere_volume(plan%diameter(1))
      plan%material = case%powders(settings%powder)%material
      plan%known = .true.
    end associate
  end subroutine new_parcel_plan

  !> The ends of the parcels' distribution, as far as so many parcels reach them.
  subroutine find_extremes(sizes, weighting, plan)
    type(quantiles_t), intent(in) :: sizes
    type(weighting_t), intent(in) :: weighting
    type(parcel_plan_t), intent(inout) :: plan

    real(wp) :: tail

    tail = min(0.5_wp, 0.5_wp/max(plan%parcels, 1.0_wp))
    plan%particle = [sizes%at(tail), sizes%at(1 - tail)]
    plan%diameter = weighting%collision_diameter(plan%particle)
    plan%weight = weighting%weight(plan%particle)
    plan%weight = [minval(plan%weight), maxval(plan%weight)]
  end subroutine find_extremes

  !> The shortest collision, or swing by attraction, of the parcels of all plans that are known; huge if none is [s].
  pure function shortest_contact(case, plans) result(time)
    type(case_t), intent(in) :: case
    type(parcel_plan_t), intent(in) :: plans(:)
    real(wp) :: time

    type(contact_laws_t) :: laws
    real(wp), allocatable :: lightest(:), smallest(:)
    real(wp) :: ratio
    integer :: i

    laws = new_contact_laws(case%contact, case%wall_materials())
    ratio = 0.0_wp
    allocate (lightest(0:laws%materials()), smallest(0:laws%materials()), source=huge(time))
    do i = 1, size(plans)
      if (.not. plans(i)%known) cycle
      associate (m => plans(i)%material)
        ratio = max(ratio, plans(i)%diameter(1)/2/plans(i)%lightest)
        lightest(m) = min(lightest(m), plans(i)%lightest)
        smallest(m) = min(smallest(m), plans(i)%diameter(1)/2)
      end associate
    end do
    time = min(laws%contact_time(lightest, smallest, case%contact%impact_velocity), laws%swing_time(ratio))
  end function shortest_contact

end module parcel_plan
